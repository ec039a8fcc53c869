//! Output that nobody can read: a reader that has gone, a full disk, a closed terminal. No command panics or hangs.

use crate::space::Space;
use std::fs::OpenOptions;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, ExitStatus, Stdio};

const CAMPAIGN: &str = include_str!("campaign.toml");

/// Every command, with its arguments.
const COMMANDS: [&str; 30] = [
    "run w.toml",
    "run w.toml --json",
    "run v.toml --store other",
    "plan w.toml",
    "plan v.toml --json",
    "check w.toml",
    "check w.toml --json",
    "check none.toml",
    "show w.toml table",
    "show w.toml table --csv",
    "show w.toml table --json",
    "show w.toml none",
    "graph w.toml",
    "report w.toml -o -",
    "export w.toml",
    "diff w.toml v.toml",
    "diff w.toml v.toml --json",
    "calibrate w.toml",
    "calibrate w.toml --page -",
    "store ls",
    "store verify",
    "store gc w.toml",
    "store du",
    "store audit w.toml",
    "schema",
    "completions bash",
    "site",
    "new",
    "run --help",
    "--version",
];

/// The exit code, which is one of flow's own: no panic, no signal.
fn judged(status: ExitStatus, what: &str) -> i32 {
    assert_eq!(status.signal(), None, "{what}: {status}");
    let code = status.code().expect("a code");
    assert!(code <= 3, "{what}: {status}");
    code
}

#[test]
fn no_command_minds_that_nobody_can_read() {
    let space = Space::new();
    space.write("w.toml", CAMPAIGN);
    space.write("v.toml", &CAMPAIGN.replace("\"3*a + b", "\"4*a + b"));
    space.run(&[]);
    let full = || Stdio::from(OpenOptions::new().write(true).open("/dev/full").expect("/dev/full"));
    let code = |command: &mut Command, what: &str| judged(command.status().expect("flow"), what);
    for words in COMMANDS {
        let words: Vec<&str> = words.split(' ').collect();
        let what = |of: &str| format!("{} / {of}", words.join(" "));
        // The order: as all is well, first.
        let usual = code(space.command(&words).stdout(Stdio::null()).stderr(Stdio::null()), &what("null"));
        let lost = code(space.command(&words).stdout(full()).stderr(full()), &what("full"));
        // A result that cannot be written is no success; a fault stays what it is, and a run counts by its results.
        if usual == 0 && !matches!(words[0], "run" | "check" | "export" | "new" | "site") {
            assert_eq!(lost, 3, "{}", what("full"));
        } else if words[0] != "run" && usual != 0 {
            assert!(lost == usual || lost == 3, "{}: {lost}", what("full"));
        }
        let mut closed = Command::new("sh");
        closed.args(["-c", "exec \"$0\" \"$@\" <&- >&- 2>&-", env!("CARGO_BIN_EXE_flow")]).args(&words);
        code(closed.current_dir(space.path("")), &what("closed"));
        let mut gone = space.start(&words);
        drop((gone.stdout.take(), gone.stderr.take()));
        judged(gone.wait().expect("flow"), &what("gone"));
    }
}
