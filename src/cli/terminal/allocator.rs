//! The allocator: if the system refuses memory, it ends the program with a message and exit code 4.
//!
//! It contains all unsafe code of the program, which an allocator needs.
#![expect(unsafe_code, reason = "the trait of allocators and the C library are unsafe")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Write as _, stderr};
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use std::thread;
use std::time::Duration;

use crate::store::try_abandon_unfinished;

use super::exit::Exit;

/// The system's allocator; without memory it ends the program.
#[derive(Debug)]
pub struct SystemOrEnd;

// SAFETY: every call goes to the system's allocator unchanged, and its result is returned.
unsafe impl GlobalAlloc for SystemOrEnd {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        given(unsafe { System.realloc(block, layout, size) }, size)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        unsafe { System.dealloc(block, layout) }
    }
}

#[inline]
fn given(block: *mut u8, bytes: usize) -> *mut u8 {
    if block.is_null() {
        end(bytes);
    }
    block
}

/// Memory released when the system refuses more, so that unfinished files can be removed.
static RESERVE: AtomicPtr<u8> = AtomicPtr::new(ptr::null_mut());

/// Size of the reserve: removing a folder reads its names into 32 KB.
const RESERVED: Layout = Layout::new::<[u8; 1 << 18]>();

/// Reserves memory for the end of a program without further memory.
pub(super) fn reserve() {
    // SAFETY: the size is not zero.
    RESERVE.store(unsafe { System.alloc(RESERVED) }, Ordering::Release);
}

/// Ends the program. The thread may hold any lock, so this waits for no lock without a limit, and takes no memory
/// before it has printed the message.
#[cold]
fn end(bytes: usize) -> ! {
    static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
    if HAS_BEGUN.swap(true, Ordering::AcqRel) {
        // Another thread ends the program, or the removal below found no memory.
        thread::sleep(Duration::from_secs(1));
    } else {
        let hint =
            "`ulimit` may limit it; fewer --threads need less; a sweep goes on with --resume";
        let message = "error: out of memory: the system refuses another";
        let _ = stderr().write_fmt(format_args!("{message} {bytes} bytes\nhint: {hint}\n"));
        let reserve = RESERVE.swap(ptr::null_mut(), Ordering::AcqRel);
        if !reserve.is_null() {
            // SAFETY: `reserve` got it from this allocator with this layout, and nobody else has it now.
            unsafe { System.dealloc(reserve, RESERVED) }
        }
        try_abandon_unfinished();
    }
    // A usual exit may take memory.
    #[cfg(unix)]
    signal_hook::low_level::exit(Exit::NotSolvable as i32);
    #[cfg(not(unix))]
    #[expect(clippy::exit, reason = "there is no memory to return with")]
    std::process::exit(Exit::NotSolvable as i32)
}

/// Makes glibc keep freed memory, up to 64 MB an arena, and serve blocks of up to 32 MB from it. A sweep allocates the
/// same blocks for every case: it takes a third longer with fresh pages each time. Call it before the program starts
/// threads.
pub fn keep_freed_memory() {
    const M_TRIM_THRESHOLD: i32 = -1;
    const M_MMAP_THRESHOLD: i32 = -3;
    mallopt(M_TRIM_THRESHOLD, 1 << 26);
    mallopt(M_MMAP_THRESHOLD, 1 << 25);
}

/// Limits the arenas of glibc, one for every thread by default: each arena reserves 64 MB of address space, 128 MB at
/// first. Call it before the program starts threads.
pub(super) fn limit_arenas(most: usize) {
    const M_ARENA_MAX: i32 = -8;
    mallopt(M_ARENA_MAX, i32::try_from(most).unwrap_or(i32::MAX));
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
unsafe extern "C" {
    safe fn mallopt(parameter: i32, value: i32) -> i32;
}

/// Other C libraries have no such settings.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn mallopt(_: i32, _: i32) -> i32 {
    0
}
