//! How much memory the machine has left for this program.

use std::fs;
use std::path::{Path, PathBuf};

/// Memory in bytes that this program can take before something gives way: what the system has
/// available, and no more than its limits leave; none where the system does not tell.
pub fn available_memory() -> Option<u64> {
    let system = read("/proc/meminfo").and_then(|text| kilobytes(&text, "MemAvailable:"));
    let groups = read("/proc/self/cgroup")
        .and_then(|groups| room_in_groups(Path::new("/sys/fs/cgroup"), &groups));
    [system, groups, available_addresses()].into_iter().flatten().min()
}

/// Memory in bytes that the limit of this process's address space (`ulimit -v`) leaves; none where
/// there is none.
pub fn available_addresses() -> Option<u64> {
    let limits = read("/proc/self/limits")?;
    // Where there is no limit, what is used need not be asked.
    let limit = address_space(&limits)?;
    let used = read("/proc/self/status").and_then(|text| kilobytes(&text, "VmSize:"))?;
    Some(limit.saturating_sub(used))
}

/// The least that a control group of this process, or one around it, leaves; `groups` is the
/// system's list of them, a line `NUMBER:CONTROLLERS:/PATH` each.
fn room_in_groups(mounted: &Path, groups: &str) -> Option<u64> {
    let rooms = groups.lines().filter_map(|line| {
        let (_, rest) = line.split_once(':')?;
        let (controllers, path) = rest.split_once(':')?;
        let (root, names) = match controllers {
            "" => (mounted.to_owned(), &SECOND_VERSION),
            _ if controllers.split(',').any(|name| name == "memory") => {
                (mounted.join("memory"), &FIRST_VERSION)
            }
            _ => return None,
        };
        around(&root, path).iter().filter_map(|group| room_in(group, names)).min()
    });
    rooms.min()
}

/// Where a group tells of its memory.
struct GroupFiles {
    limit: &'static str,
    used: &'static str,
    /// Key in memory.stat of what is used, but only as long as no one else needs it.
    given_back: &'static str,
}

const FIRST_VERSION: GroupFiles = GroupFiles {
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    given_back: "total_inactive_file ",
};

const SECOND_VERSION: GroupFiles =
    GroupFiles { limit: "memory.max", used: "memory.current", given_back: "inactive_file " };

/// The folder of a group and those of the groups around it.
fn around(root: &Path, path: &str) -> Vec<PathBuf> {
    let own = root.join(path.trim_start_matches('/'));
    own.ancestors().take_while(|folder| folder.starts_with(root)).map(Path::to_owned).collect()
}

const NO_LIMIT: u64 = 1 << 60;

/// What one group leaves; none where it sets no limit.
fn room_in(group: &Path, names: &GroupFiles) -> Option<u64> {
    let number = |name| whole(&read(group.join(name))?);
    // The first version says "none" by a number that no machine has; what is used need not be asked.
    let limit = number(names.limit).filter(|limit| *limit < NO_LIMIT)?;
    let used = number(names.used)?;
    let given_back = read(group.join("memory.stat"))
        .and_then(|text| whole(text.lines().find_map(|line| line.strip_prefix(names.given_back))?));
    Some(limit.saturating_sub(used.saturating_sub(given_back.unwrap_or(0))))
}

fn read(path: impl AsRef<Path>) -> Option<String> {
    fs::read_to_string(path).ok()
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

    /// A folder like the system's own, with these files.
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

    #[test]
    fn groups_of_the_first_version_are_read_where_memory_is_theirs() {
        let root = mounted(&[
            ("memory/memory.limit_in_bytes", "9223372036854771712\n"),
            ("memory/memory.usage_in_bytes", "5000\n"),
            ("memory/job/memory.limit_in_bytes", "3000\n"),
            ("memory/job/memory.usage_in_bytes", "4000\n"),
            ("memory/job/memory.stat", "total_inactive_file 1500\n"),
        ]);
        let groups = "5:cpu,memory:/job\n2:pids:/job\n0::/\n";
        assert_eq!(room_in_groups(root.path(), groups), Some(500));
        assert_eq!(room_in_groups(root.path(), "2:pids:/job\n"), None);
    }
}
