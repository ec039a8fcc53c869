//! The mark by which all processes that descend from a campaign are known, whatever they do with their group, session,
//! environment, folder and streams.
//!
//! A process inherits its limits, and without privileges can never raise one again. So a campaign sets the limit on the time
//! of real-time threads (`RLIMIT_RTTIME`), which nobody sets, to a number of its own: more than 70,000 years, which limits
//! nothing. `/proc/PID/limits` shows it. Within another campaign the mark of the outer one stays.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use std::path::Path;

/// How `/proc/PID/limits` begins the line of this limit.
const LINE: &str = "Max realtime timeout";

/// The number that marks a campaign, from its process and when that started; microseconds.
pub(super) fn mark_of(owner: &str) -> u64 {
    let hash = blake3::hash(owner.as_bytes());
    let mut first = [0; 8];
    first.copy_from_slice(&hash.as_bytes()[..8]);
    // Below 2⁶³, which systems may take for no limit, and so large that it never ends anything.
    1 << 61 | u64::from_le_bytes(first) >> 3
}

/// Marks this process and all that it will start, unless a limit is set already.
pub(super) fn mark_own(owner: &str) {
    if getrlimit(Resource::Rttime).maximum.is_none() {
        let mark = Some(mark_of(owner));
        // Without it a process is still known by its environment and folder.
        let _ = setrlimit(Resource::Rttime, Rlimit { current: mark, maximum: mark });
    }
}

/// Whether the process of this folder of `/proc` has the mark.
pub(super) fn is_marked(process: &Path, mark: u64) -> bool {
    let limits = std::fs::read_to_string(process.join("limits")).unwrap_or_default();
    has_limit(&limits, mark)
}

fn has_limit(limits: &str, mark: u64) -> bool {
    let line = limits.lines().find_map(|line| line.strip_prefix(LINE));
    line.and_then(|values| values.split_whitespace().nth(1)).is_some_and(|hard| hard == mark.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_limits_nothing_and_differs_between_campaigns() {
        const YEAR: u64 = 366 * 24 * 3600 * 1_000_000;
        let owners = ["1 1", "1 2", "2 1", "11 1"];
        for owner in owners {
            assert!(mark_of(owner) / YEAR > 70_000 && mark_of(owner) < 1 << 63);
            assert_eq!(owners.iter().filter(|other| mark_of(other) == mark_of(owner)).count(), 1);
        }
    }

    #[test]
    fn the_hard_limit_is_what_cannot_be_changed() {
        let limits = |soft: &str, hard: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units     \n\
                 Max cpu time              7                    7                    seconds   \n\
                 Max realtime timeout      {soft}            {hard}            us        \n"
            )
        };
        assert!(has_limit(&limits("7", "7"), 7) && has_limit(&limits("0", "7"), 7));
        assert!(!has_limit(&limits("7", "unlimited"), 7) && !has_limit(&limits("7", "77"), 7) && !has_limit("", 7));
    }
}
