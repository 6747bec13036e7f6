//! Which signals this program was started to ignore.

use std::fs;

/// Those of `signals` that whoever started this program had it ignore, as `nohup` does with SIGHUP and
/// a shell with the SIGINT of a script's background; none where the system does not tell.
pub fn ignored_signals(signals: &[i32]) -> Option<Vec<i32>> {
    let mask = ignored_mask(&fs::read_to_string("/proc/self/status").ok()?)?;
    Some(signals.iter().copied().filter(|signal| is_in(mask, *signal)).collect())
}

/// `SigIgn` of the system's words on a process, in hexadecimal.
fn ignored_mask(status: &str) -> Option<u64> {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}

/// Whether bit n − 1 is set for signal n.
fn is_in(mask: u64, signal: i32) -> bool {
    let bit = u32::try_from(signal).ok().and_then(|signal| signal.checked_sub(1));
    bit.and_then(|bit| mask.checked_shr(bit)).is_some_and(|rest| rest & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bit_of_the_mask_is_a_signal_counted_from_one() {
        let status = "Name:\tflexlink\nSigBlk:\tffffffffffffffff\nSigIgn:\t8000000000000003\n";
        let mask = ignored_mask(status).unwrap();
        let ignored: Vec<i32> = (-1..=65).filter(|signal| is_in(mask, *signal)).collect();
        assert_eq!(ignored, [1, 2, 64]);
        assert_eq!(ignored_mask("Name:\tflexlink\n"), None);
        assert_eq!(ignored_mask("SigIgn:\tmany\n"), None);
    }
}
