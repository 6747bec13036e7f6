//! Which signals this program was started to ignore.

use std::fs;

/// Whether whoever started this program had it ignore a signal, as `nohup` does with SIGHUP and a
/// shell with the SIGINT of a script's background; none where the system does not tell.
pub fn is_signal_ignored(signal: i32) -> Option<bool> {
    ignores(&fs::read_to_string("/proc/self/status").ok()?, signal)
}

/// The same from the system's words on a process: bit n − 1 of `SigIgn`, in hexadecimal, is signal n.
fn ignores(status: &str, signal: i32) -> Option<bool> {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
    let mask = u64::from_str_radix(mask.trim(), 16).ok()?;
    let bit = u32::try_from(signal).ok()?.checked_sub(1)?;
    Some(mask.checked_shr(bit)? & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bit_of_the_mask_is_a_signal_counted_from_one() {
        let status = "Name:\tflexlink\nSigBlk:\tffffffffffffffff\nSigIgn:\t8000000000000003\n";
        let ignored = |signal| ignores(status, signal);
        for signal in [1, 2, 64] {
            assert_eq!(ignored(signal), Some(true), "{signal}");
        }
        for signal in [3, 15, 63] {
            assert_eq!(ignored(signal), Some(false), "{signal}");
        }
        for signal in [-1, 0, 65] {
            assert_eq!(ignored(signal), None, "{signal}");
        }
        assert_eq!(ignores("Name:\tflexlink\n", 2), None);
        assert_eq!(ignores("SigIgn:\tmany\n", 2), None);
    }
}
