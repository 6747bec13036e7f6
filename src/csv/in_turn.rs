//! Texts that are made in parallel and written in order.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Texts that may be made for each thread before the one whose turn it is.
const AHEAD: usize = 2;

/// How far the writing is.
struct Turn<'a> {
    /// Number of the text that is to be written next.
    block: usize,
    /// None while a thread writes.
    out: Option<&'a mut (dyn Write + Send)>,
    /// Texts that are made and not yet written, by number.
    made: BTreeMap<usize, Vec<u8>>,
    /// Memory of texts that are written, for further ones.
    spare: Vec<Vec<u8>>,
    written: io::Result<()>,
}

/// Blocks that threads take one after the other, make and hand in. Who hands one in writes it, and all
/// that are ready after it, unless another thread does so; who is far ahead waits.
struct Blocks<'a> {
    next: AtomicUsize,
    turn: Mutex<Turn<'a>>,
    moved: Condvar,
    /// How far ahead of the text to be written next one may be handed in.
    room: usize,
}

/// Writes the texts of `blocks` blocks, each made by `make`, in their order; `make` appends the text
/// of a block to what it is given, which is empty.
///
/// # Errors
/// Those of `out`.
pub(super) fn write_in_turn(
    out: &mut (dyn Write + Send),
    blocks: usize,
    make: impl Fn(usize, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    // A thread that is busy elsewhere is not waited for: others find its share done.
    let threads = rayon::current_num_threads().min(blocks);
    let (made, spare) = (BTreeMap::new(), vec![]);
    let turn = Turn { block: 0, out: Some(out), made, spare, written: Ok(()) };
    let queue = Blocks {
        next: AtomicUsize::new(0),
        turn: Mutex::new(turn),
        moved: Condvar::new(),
        room: AHEAD * threads,
    };
    let work = || {
        let mut text = Vec::new();
        let _leaving = Leaving(&queue);
        loop {
            let block = queue.next.fetch_add(1, Ordering::Relaxed);
            if block >= blocks {
                break;
            }
            make(block, &mut text);
            let Some(empty) = queue.hand_in(block, text) else { break };
            text = empty;
        }
    };
    rayon::scope(|scope| (0..threads).for_each(|_| scope.spawn(|_| work())));
    queue.turn.into_inner().unwrap_or_else(PoisonError::into_inner).written
}

impl Turn<'_> {
    /// The text whose turn it is, where it is made and there is sense in writing it.
    fn ready(&mut self) -> Option<Vec<u8>> {
        self.written.as_ref().ok()?;
        self.made.remove(&self.block)
    }
}

impl<'a> Blocks<'a> {
    /// Takes the text of a block, and sees to it that it is written when all before it are; returns an
    /// empty text, or none where there is no sense in going on.
    fn hand_in(&self, block: usize, text: Vec<u8>) -> Option<Vec<u8>> {
        let is_full = |turn: &mut Turn| turn.written.is_ok() && block >= turn.block + self.room;
        let turn = self.moved.wait_while(self.lock(), is_full);
        let mut turn = turn.unwrap_or_else(PoisonError::into_inner);
        turn.made.insert(block, text);
        if let Some(out) = turn.out.take() {
            while let Some(mut text) = turn.ready() {
                // Others make and hand in meanwhile.
                drop(turn);
                let written = out.write_all(&text);
                text.clear();
                turn = self.lock();
                turn.block += 1;
                turn.spare.push(text);
                // A thread that panicked meanwhile has told so, and is not to be forgotten.
                if turn.written.is_ok() {
                    turn.written = written;
                }
                self.moved.notify_all();
            }
            turn.out = Some(out);
        }
        turn.written.is_ok().then(|| turn.spare.pop().unwrap_or_default())
    }

    fn lock(&self) -> MutexGuard<'_, Turn<'a>> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Sends everyone home where a thread panics before it has handed in its block, which would never
/// come.
struct Leaving<'a, 'b>(&'a Blocks<'b>);

impl Drop for Leaving<'_, '_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.lock().written = Err(io::Error::other("a text could not be made"));
            self.0.moved.notify_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
    }

    /// Blocks of uneven work.
    fn text(block: usize, out: &mut Vec<u8>) {
        let busy: f64 = (0..block % 7 * 500).map(|k| k as f64).sum();
        out.extend(format!("{block}:{busy};").as_bytes());
    }

    #[test]
    fn texts_stand_in_order_on_any_number_of_threads() {
        let mut expected = vec![];
        (0..300).for_each(|block| text(block, &mut expected));
        for threads in [1, 2, 7] {
            let mut out = vec![];
            on_threads(threads, || write_in_turn(&mut out, 300, text)).unwrap();
            assert!(out == expected, "{threads} threads");
        }
        let mut out = vec![];
        write_in_turn(&mut out, 0, text).unwrap();
        assert!(out.is_empty());
    }

    struct Full(usize);

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0 = self.0.checked_sub(1).ok_or(io::ErrorKind::StorageFull)?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn an_error_ends_the_work_and_is_told() {
        let made = AtomicUsize::new(0);
        let make = |block: usize, out: &mut Vec<u8>| {
            made.fetch_add(1, Ordering::Relaxed);
            text(block, out);
        };
        let written = on_threads(3, || write_in_turn(&mut Full(5), 100_000, make));
        assert_eq!(written.unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert!(made.into_inner() < 100);
    }

    #[test]
    fn few_texts_are_made_before_the_one_whose_turn_it_is() {
        let made = AtomicUsize::new(0);
        let make = |block: usize, out: &mut Vec<u8>| {
            if block == 0 {
                // As long as the others get on.
                let mut before = usize::MAX;
                while before != made.load(Ordering::Relaxed) {
                    before = made.load(Ordering::Relaxed);
                    std::thread::sleep(std::time::Duration::from_millis(20));
                }
                assert!(before <= 3 * (AHEAD + 1), "{before} texts are made");
            }
            made.fetch_add(1, Ordering::Relaxed);
            text(block, out);
        };
        on_threads(3, || write_in_turn(&mut vec![], 1000, make)).unwrap();
        assert_eq!(made.into_inner(), 1000);
    }

    #[test]
    #[should_panic(expected = "a broken pipe")]
    fn a_panic_while_writing_is_passed_on_and_leaves_no_one_waiting() {
        struct Broken;
        impl Write for Broken {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                panic!("a broken pipe")
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let _ = on_threads(3, || write_in_turn(&mut Broken, 1000, text));
    }

    #[test]
    #[should_panic(expected = "block 4")]
    fn a_panic_is_passed_on_and_leaves_no_one_waiting() {
        let make = |block: usize, _: &mut Vec<u8>| assert_ne!(block, 4, "block {block}");
        let mut out = vec![];
        let _ = on_threads(3, || write_in_turn(&mut out, 50, make));
    }
}
