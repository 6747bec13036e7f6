//! Memory that the system refuses, where no estimate has foreseen it, ends the program as any other
//! refusal does: a message, nothing left behind, exit code 4.
//!
//! Here is all the unsafe code of the program. An allocator cannot be written without.

use std::alloc::{GlobalAlloc, Layout, System};
use std::fmt::Arguments;
use std::hint::black_box;
use std::panic;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use flexlink::store::abandon_unfinished_soon;

use super::console;
use super::exit::Exit;

#[global_allocator]
static ALLOCATOR: SystemOrEnd = SystemOrEnd;

/// The system's allocator; where that gives nothing, the program ends.
struct SystemOrEnd;

// SAFETY: every call goes to the system's allocator as it came, and what that gives is returned.
#[expect(unsafe_code, reason = "the trait is unsafe")]
unsafe impl GlobalAlloc for SystemOrEnd {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps what the system's allocator asks for; so below.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        given(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) }
    }
}

#[inline]
fn given(block: *mut u8, bytes: usize) -> *mut u8 {
    if block.is_null() && IS_READY.load(Ordering::Acquire) {
        end(format_args!("another {bytes} bytes"));
    }
    block
}

/// Memory that the end takes: for its message, and to remove what is unfinished.
const RESERVE_BYTES: usize = 1 << 20;

static RESERVE: Mutex<Vec<u8>> = Mutex::new(Vec::new());
static IS_READY: AtomicBool = AtomicBool::new(false);
/// Whether a thread ends the program, and has told so.
static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
static IS_TOLD: AtomicBool = AtomicBool::new(false);

/// From now on the end of memory ends the program; before, it aborts it.
pub(crate) fn end_where_memory_does() {
    IS_READY.store(true, Ordering::Release);
    let reserve = Vec::with_capacity(RESERVE_BYTES);
    if let Ok(mut kept) = RESERVE.lock() {
        *kept = black_box(reserve);
    }
    // A thread that has its stack may find no memory for the handler of its overflow.
    let told = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        let words = panic.payload().downcast_ref::<String>();
        if words.is_some_and(|words| words.contains("alternative stack")) {
            end(format_args!("what a thread begins with"));
        }
        told(panic);
    }));
    #[cfg(unix)]
    {
        use std::sync::Arc;

        use signal_hook::{consts::SIGABRT, flag::register_conditional_shutdown};

        // The C library aborts where it needs memory for itself, in words of its own.
        let always = Arc::new(AtomicBool::new(true));
        let _ = register_conditional_shutdown(SIGABRT, Exit::NotSolvable as i32, always);
    }
}

/// Ends the program, which the system refuses some memory.
///
/// The calling thread may hold any lock: nothing here waits for one without end.
#[cold]
fn end(refused: Arguments) -> ! {
    if HAS_BEGUN.swap(true, Ordering::AcqRel) {
        // Another thread ends the program; or none can, as the reserve was not enough, or a thread
        // that sleeps here has what is needed.
        thread::sleep(PATIENCE * 2);
        if !IS_TOLD.load(Ordering::Acquire) {
            console::out_of_memory();
        }
        leave();
    }
    if let Ok(mut reserve) = RESERVE.try_lock() {
        *reserve = Vec::new();
    }
    abandon_unfinished_soon(PATIENCE);
    let message = format!("out of memory: the system refuses {refused}");
    let hint = "`ulimit` may limit it; fewer --threads need less; a sweep goes on with --resume";
    console::clear_line();
    console::error(&message, Some(hint));
    IS_TOLD.store(true, Ordering::Release);
    leave()
}

/// How long is waited for what other threads are about to finish.
const PATIENCE: Duration = Duration::from_secs(1);

/// Ends the process without another word: what would be done on a usual way out may take memory.
fn leave() -> ! {
    #[cfg(unix)]
    signal_hook::low_level::exit(Exit::NotSolvable as i32);
    #[cfg(not(unix))]
    #[expect(clippy::exit, reason = "there is no memory to return with")]
    std::process::exit(Exit::NotSolvable as i32);
}

/// Has threads share arenas, the C library's stocks of memory, where the address space is limited to
/// `left` more bytes: each arena reserves 64 MB of it, 128 MB for a moment, and by default every thread
/// has its own.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub(crate) fn share_arenas(left: usize) {
    let arenas = i32::try_from(left / (512 << 20)).unwrap_or(i32::MAX).max(1);
    // SAFETY: glibc allows the call at any time; it changes a number.
    #[expect(unsafe_code, reason = "a function of the C library")]
    unsafe {
        libc::mallopt(libc::M_ARENA_MAX, arenas)
    };
}

/// Other C libraries reserve none.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(crate) fn share_arenas(_: usize) {}
