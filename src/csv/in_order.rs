//! Text that is made in parallel and written in order.

use std::io::{self, Write};

use rayon::prelude::*;

/// Blocks that each thread makes in a round.
const BLOCKS_PER_THREAD: usize = 2;

/// Writes the text of `blocks` blocks in their order; `make` appends the text of one block to an empty
/// buffer.
///
/// All threads make a round of blocks while one of them writes the round before, so that two rounds at
/// most are in memory.
///
/// # Errors
/// Those of `out`.
pub(super) fn write_in_order(
    out: &mut (dyn Write + Send),
    blocks: usize,
    make: impl Fn(usize, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    let at_once = BLOCKS_PER_THREAD * rayon::current_num_threads();
    let (mut made, mut next) = (Vec::new(), Vec::new());
    let mut start = 0;
    while start < blocks || !made.is_empty() {
        next.resize_with(at_once.min(blocks - start), Vec::new);
        let (written, ()) = rayon::join(
            || made.iter().try_for_each(|text: &Vec<u8>| out.write_all(text)),
            || {
                next.par_iter_mut().enumerate().with_max_len(1).for_each(|(k, text)| {
                    text.clear();
                    make(start + k, text);
                });
            },
        );
        written?;
        start += next.len();
        std::mem::swap(&mut made, &mut next);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

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
    fn texts_are_in_order_on_any_number_of_threads() {
        for blocks in [0, 1, 2, 4, 299, 300] {
            let mut expected = vec![];
            (0..blocks).for_each(|block| text(block, &mut expected));
            for threads in [1, 2, 7] {
                let mut out = vec![];
                on_threads(threads, || write_in_order(&mut out, blocks, text)).unwrap();
                assert!(out == expected, "{blocks} blocks on {threads} threads");
            }
        }
    }

    /// A disk that is full after some writes.
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
    fn an_error_ends_the_work_and_is_returned() {
        let made = AtomicUsize::new(0);
        let make = |block: usize, out: &mut Vec<u8>| {
            made.fetch_add(1, Ordering::Relaxed);
            text(block, out);
        };
        let written = on_threads(3, || write_in_order(&mut Full(5), 100_000, make));
        assert_eq!(written.unwrap_err().kind(), io::ErrorKind::StorageFull);
        assert!(made.into_inner() < 100);
    }

    #[test]
    #[should_panic(expected = "block 4")]
    fn a_panic_is_passed_on_and_no_thread_waits() {
        let make = |block: usize, _: &mut Vec<u8>| assert_ne!(block, 4, "block {block}");
        let mut out = vec![];
        let _ = on_threads(3, || write_in_order(&mut out, 50, make));
    }
}
