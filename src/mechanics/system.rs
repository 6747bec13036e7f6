//! Memory available to this process, and early end of long work.

use std::cell::OnceCell;
use std::fs;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    /// Flag that ends the work of this thread.
    static STOP: OnceCell<Arc<AtomicBool>> = const { OnceCell::new() };
}

/// Payload of the unwinding when a flag ends the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stopped;

/// Makes `end_if_stopped` end the work of this thread once the flag is true. A thread keeps its first flag.
pub fn stop_by(flag: Arc<AtomicBool>) {
    STOP.with(|own| drop(own.set(flag)));
}

/// Ends the work of this thread if its flag is true: unwinds with [`Stopped`], without a call of the panic hook. Long
/// loops call it at least every tenth of a second.
pub(crate) fn end_if_stopped() {
    if STOP.with(|own| own.get().is_some_and(|flag| flag.load(Ordering::Relaxed))) {
        resume_unwind(Box::new(Stopped));
    }
}

/// Memory in bytes that this process can take: the least of the system's available memory, the room in its control
/// groups and the room below the limit of its address space. `None` if the system gives no number, as on other systems
/// than Linux.
pub fn available_memory() -> Option<u64> {
    let system = read("/proc/meminfo").and_then(|text| kilobytes(&text, "MemAvailable:"));
    let groups = read("/proc/self/cgroup")
        .and_then(|groups| room_in_groups(Path::new("/sys/fs/cgroup"), &groups));
    [system, groups, available_addresses()].into_iter().flatten().min()
}

/// Room in bytes below the limit of this process's address space (`ulimit -v`); `None` without a limit.
pub fn available_addresses() -> Option<u64> {
    let limits = read("/proc/self/limits")?;
    let limit = soft_limit(&limits, "Max address space")?;
    let used = read("/proc/self/status").and_then(|text| kilobytes(&text, "VmSize:"))?;
    Some(limit.saturating_sub(used))
}

/// Smallest room in bytes of the process's control group (cgroup v2) and the groups around it; `groups` is the content
/// of `/proc/self/cgroup`, in which version 2 has the line `0::/PATH`.
fn room_in_groups(mounted: &Path, groups: &str) -> Option<u64> {
    let path = groups.lines().find_map(|line| line.strip_prefix("0::"))?;
    let own = mounted.join(path.trim_start_matches('/'));
    own.ancestors().take_while(|group| group.starts_with(mounted)).filter_map(room_in).min()
}

/// Room in bytes of one group, with its cached files counted as free; `None` without a limit.
fn room_in(group: &Path) -> Option<u64> {
    let number = |name| whole(&read(group.join(name))?);
    let limit = number("memory.max")?;
    let used = number("memory.current")?;
    let cached = read(group.join("memory.stat"))
        .and_then(|text| whole(text.lines().find_map(|line| line.strip_prefix("inactive_file "))?));
    Some(limit.saturating_sub(used.saturating_sub(cached.unwrap_or(0))))
}

fn read(path: impl AsRef<Path>) -> Option<String> {
    fs::read_to_string(path).ok()
}

/// Number of a line `NAME   123 kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    whole(rest.strip_suffix("kB")?).map(|kilobytes| kilobytes.saturating_mul(1024))
}

/// True if this process's data is limited (`ulimit -d`), whatever the limit.
pub fn is_data_limited() -> bool {
    read("/proc/self/limits").is_some_and(|limits| soft_limit(&limits, "Max data size").is_some())
}

/// A soft limit in bytes; `None` if it is unlimited.
fn soft_limit(limits: &str, name: &str) -> Option<u64> {
    let rest = limits.lines().find_map(|line| line.strip_prefix(name))?;
    whole(rest.split_whitespace().next()?)
}

fn whole(text: &str) -> Option<u64> {
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_ends_where_its_own_flag_is_true() {
        let work = |is_stopped| {
            let flag = Arc::new(AtomicBool::new(is_stopped));
            let work = move || {
                stop_by(flag);
                end_if_stopped();
            };
            std::thread::spawn(work).join().map_err(|panic| panic.is::<Stopped>())
        };
        assert_eq!((work(false), work(true)), (Ok(()), Err(true)));
        end_if_stopped();
    }

    #[test]
    fn what_the_system_tells_is_read() {
        let told = "MemTotal:       24643584 kB\nMemFree:        19088000 kB\n\
                    MemAvailable:   22600192 kB\n";
        assert_eq!(kilobytes(told, "MemAvailable:"), Some(22_600_192 * 1024));
        assert_eq!(kilobytes(told, "SwapFree:"), None);
        let limits = "Limit             Soft Limit  Hard Limit  Units\n\
                      Max address space 2048000000  unlimited   bytes\n";
        let space = |limits: &str| soft_limit(limits, "Max address space");
        assert_eq!(space(limits), Some(2_048_000_000));
        assert_eq!(space(&limits.replace("2048000000", "unlimited ")), None);
    }

    /// A folder like the system's, with these files.
    fn mounted(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, content) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, content).unwrap();
        }
        root
    }

    #[test]
    fn the_narrowest_of_nested_groups_counts_and_cached_files_are_given_back() {
        let root = mounted(&[
            ("batch/memory.max", "1000\n"),
            ("batch/memory.current", "700\n"),
            ("batch/memory.stat", "anon 100\ninactive_file 250\nactive_file 50\n"),
            ("batch/job/memory.max", "max\n"),
            ("batch/job/memory.current", "400\n"),
        ]);
        assert_eq!(room_in_groups(root.path(), "0::/batch/job\n"), Some(1000 - (700 - 250)));
        assert_eq!(room_in_groups(root.path(), "0::/elsewhere\n"), None);
        assert_eq!(room_in_groups(root.path(), "nonsense\n"), None);
    }
}
