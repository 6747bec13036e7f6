//! How much memory the machine has left for this program.

use std::fs;

/// Memory in bytes that this program can take before something gives way: what the system has
/// available, and no more than its limits leave; none where the system does not tell.
pub fn available_memory() -> Option<u64> {
    let read = |path| fs::read_to_string(path).ok();
    let system = read("/proc/meminfo").and_then(|text| kilobytes(&text, "MemAvailable:"));
    let group = read("/sys/fs/cgroup/memory.max").and_then(|limit| {
        let used = read("/sys/fs/cgroup/memory.current")?;
        Some(whole(&limit)?.saturating_sub(whole(&used)?))
    });
    let own = read("/proc/self/limits").and_then(|limits| {
        let used = read("/proc/self/status").and_then(|text| kilobytes(&text, "VmSize:"))?;
        Some(address_space(&limits)?.saturating_sub(used))
    });
    [system, group, own].into_iter().flatten().min()
}

/// The number of a line `NAME   123 kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    whole(rest.strip_suffix("kB")?).map(|kilobytes| kilobytes.saturating_mul(1024))
}

/// The soft limit of the address space in bytes; none where it is unlimited.
fn address_space(limits: &str) -> Option<u64> {
    let rest = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    whole(rest.split_whitespace().next()?)
}

fn whole(text: &str) -> Option<u64> {
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_tells_is_read() {
        let told = "MemTotal:       24643584 kB\nMemFree:        19088000 kB\n\
                    MemAvailable:   22600192 kB\n";
        assert_eq!(kilobytes(told, "MemAvailable:"), Some(22_600_192 * 1024));
        assert_eq!(kilobytes(told, "SwapFree:"), None);
        let limits = "Limit             Soft Limit  Hard Limit  Units\n\
                      Max address space 2048000000  unlimited   bytes\n";
        assert_eq!(address_space(limits), Some(2_048_000_000));
        assert_eq!(address_space(&limits.replace("2048000000", "unlimited ")), None);
    }
}
