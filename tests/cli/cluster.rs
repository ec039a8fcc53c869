//! Workers of a cluster, with a scheduler that is a few lines of shell: what the submitter does, and what it says, when all is
//! well and when it is not. The real Slurm is met by `tests/cluster/measure.sh`, by hand.

mod trouble;

use crate::space::{Ran, Space, told};
use rustix::process::{Pid, Signal, kill_process};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const FAKES: [(&str, &str); 3] = [
    ("sbatch", include_str!("scheduler/sbatch")),
    ("squeue", include_str!("scheduler/squeue")),
    ("scancel", include_str!("scheduler/scancel")),
];

struct Cluster(Space);

impl Cluster {
    /// A workflow of so many tasks, each of which runs these lines of shell with its number in `$a`.
    fn new(tasks: usize, lines: &str, site: &str) -> Self {
        let space = Space::new();
        let levels: Vec<String> = (1..=tasks).map(|level| level.to_string()).collect();
        let workflow = format!(
            "[workflow]\nseed = 1\n[factor]\na = {{ sets = \"m.a\", levels = [{}] }}\n[response]\ny = {{}}\n\
             [material.base]\nm = {{ a = 1 }}\n[stage.grid]\nkind = \"design\"\nmethod = \"full-factorial\"\n\
             factors = [\"a\"]\n[stage.rows]\nkind = \"command\"\ndesign = \"grid\"\nmaterial = \"base\"\n\
             run = [\"sh\", \"task.sh\"]\ntemplates = {{ \"task.sh\" = \"task.sh\" }}\n\
             read.y = {{ file = \"stdout\", pattern = 'v=(\\d+)' }}\n",
            levels.join(", ")
        );
        space.write("w.toml", &workflow);
        let log = space.path("log");
        space.write("task.sh", &format!("a={{{{a}}}}; {lines}\necho $a >>{}; echo v=$a\n", log.display()));
        space.write("site.toml", &format!("linger = \"1 s\"\n{site}"));
        std::fs::create_dir(space.path("bin")).unwrap();
        for (name, text) in FAKES {
            space.write(&format!("bin/{name}"), text);
            std::fs::set_permissions(space.path(&format!("bin/{name}")), PermissionsExt::from_mode(0o755)).unwrap();
        }
        Self(space)
    }

    fn command(&self, more: &[&str]) -> Command {
        let first = ["run", "w.toml", "--executor", "slurm", "--site", "site.toml", "--json"];
        let mut command = self.0.command(&[&first, more].concat());
        let path = std::env::var("PATH").unwrap_or_default();
        command.env("PATH", format!("{}:{path}", self.0.path("bin").display()));
        command.env("FAKE", self.0.path("")).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, more: &[&str]) -> Output {
        self.command(more).output().expect("running flow")
    }

    fn start(&self) -> Child {
        self.command(&[]).spawn().expect("starting flow")
    }

    /// Tasks that were computed, by their numbers, sorted.
    fn computed(&self) -> Vec<usize> {
        let log = std::fs::read_to_string(self.0.path("log")).unwrap_or_default();
        let mut tasks: Vec<usize> = log.lines().map(|line| line.parse().unwrap()).collect();
        tasks.sort_unstable();
        tasks
    }

    /// How often a program of the scheduler was run.
    fn calls(&self, program: &str) -> usize {
        let calls = std::fs::read_to_string(self.0.path("calls")).unwrap_or_default();
        calls.lines().filter(|line| *line == program).count()
    }

    /// Jobs that are there.
    fn alive(&self) -> usize {
        let jobs = std::fs::read_to_string(self.0.path("jobs")).unwrap_or_default();
        let there = |line: &&str| {
            let stat = line.split(' ').nth(2).and_then(|pid| std::fs::read_to_string(format!("/proc/{pid}/stat")).ok());
            stat.is_some_and(|stat| !stat.contains(") Z "))
        };
        jobs.lines().filter(there).count()
    }

    fn until(&self, what: &str, is_so: impl Fn() -> bool) {
        let since = Instant::now();
        while !is_so() {
            assert!(since.elapsed() < Duration::from_secs(120), "waited in vain until {what}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let jobs = std::fs::read_to_string(self.0.path("jobs")).unwrap_or_default();
        for pid in jobs.lines().filter_map(|line| line.split(' ').nth(2)?.parse().ok()).filter_map(Pid::from_raw) {
            let own = std::fs::read(format!("/proc/{}/cmdline", pid.as_raw_pid())).unwrap_or_default();
            if own.windows(4).any(|part| part == b"work") {
                let _ = kill_process(pid, Signal::KILL);
            }
        }
    }
}

fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

#[test]
fn a_campaign_on_a_cluster_gives_what_it_gives_here_and_computes_each_task_once() {
    let cluster = Cluster::new(12, "sleep 0.1", "workers = 3\nmemory = \"100 MB\"");
    let output = cluster.run(&[]);
    assert!(output.status.success(), "{}", told(&output));
    let ran = Ran::read(&output);
    ran.expect(&[("grid", 1), ("rows", 13)]);
    assert_eq!(cluster.computed(), (1..=12).collect::<Vec<_>>());
    assert!(told(&output).contains("cluster: job 101: 3 workers for 12 tasks"), "{}", told(&output));
    assert_eq!(cluster.calls("sbatch"), 1);
    assert!(cluster.calls("squeue") <= 2, "asked at most once a minute");
    let here = cluster.0.run(&["--store", "here"]);
    assert_eq!(here.objects, ran.objects);
    let again = cluster.run(&[]);
    assert!(Ran::read(&again).ran.is_empty() && cluster.calls("sbatch") == 1, "{}", told(&again));
    // Nothing of a queue is a stranger in the store, and gc takes it away.
    assert!(!cluster.0.stdout(&["store", "verify"]).contains("not written by flow"));
    cluster.until("the workers have ended", || cluster.alive() == 0);
    cluster.0.stdout(&["store", "gc", "w.toml", "--yes"]);
    assert!(std::fs::read_dir(cluster.0.path("store/queue")).unwrap().next().is_none());
}

#[test]
fn a_lost_worker_costs_its_running_task_and_what_kills_twice_is_named() {
    let once = "[ $a = 4 ] && mkdir DIR/once && kill -9 $PPID && exit";
    let always = "[ $a = 7 ] && kill -9 $PPID && exit";
    let cluster = Cluster::new(10, "sleep 0.1; FIRST; ALWAYS", "workers = 2\nmemory = \"100 MB\"");
    let lines = std::fs::read_to_string(cluster.0.path("task.sh")).unwrap();
    let once = once.replace("DIR", &cluster.0.path("").display().to_string());
    cluster.0.write("task.sh", &lines.replace("FIRST", &once).replace("ALWAYS", always));
    let output = cluster.run(&["--keep-going"]);
    assert_eq!(output.status.code(), Some(1), "{}", told(&output));
    let all = told(&output);
    assert_eq!(cluster.computed(), [1, 2, 3, 4, 5, 6, 8, 9, 10], "{all}");
    assert!(all.contains("is gone; its task is tried again, alone"), "{all}");
    assert!(all.contains("rows[7]: its worker on ") && all.contains("the second time alone with 200 MB"), "{all}");
    assert!(!all.contains("rows[4]:"), "{all}");
}

#[test]
fn a_killed_submitter_is_followed_by_one_that_takes_the_workers_over() {
    let cluster = Cluster::new(12, "sleep 0.3", "workers = 2");
    let mut first = cluster.start();
    cluster.until("some tasks are done", || cluster.computed().len() >= 3);
    signal(&first, Signal::KILL);
    first.wait().unwrap();
    let output = cluster.run(&[]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(told(&output).contains("takes over 2 workers of an earlier run (job 101)"), "{}", told(&output));
    assert_eq!(cluster.computed(), (1..=12).collect::<Vec<_>>());
    assert_eq!(cluster.calls("sbatch"), 1);
}

#[test]
fn ctrl_c_cancels_the_jobs_and_the_end_of_the_terminal_leaves_them() {
    let cluster = Cluster::new(40, "sleep 0.3", "workers = 2");
    let first = cluster.start();
    cluster.until("some tasks are done", || cluster.computed().len() >= 2);
    signal(&first, Signal::INT);
    let output = first.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", told(&output));
    cluster.until("the jobs are gone", || cluster.alive() == 0);
    let done = cluster.computed().len();
    assert!(done < 40 && cluster.calls("scancel") == 1);
    let second = cluster.start();
    cluster.until("more tasks are done", || cluster.computed().len() >= done + 2);
    signal(&second, Signal::HUP);
    let output = second.wait_with_output().unwrap();
    let said = told(&output);
    assert!(said.contains("2 workers go on without this process; the same command takes them over"), "{said}");
    assert_eq!((output.status.code(), cluster.alive(), cluster.calls("scancel")), (Some(130), 2, 1));
    let third = cluster.run(&[]);
    assert!(third.status.success(), "{}", told(&third));
    let mut computed = cluster.computed();
    computed.dedup();
    assert_eq!(computed, (1..=40).collect::<Vec<_>>());
}

#[test]
fn a_refused_submission_is_told_and_a_limit_is_kept_to() {
    let cluster = Cluster::new(6, "sleep 0.1", "workers = 6");
    cluster.0.write("refuse", "sbatch: error: invalid partition specified: shrot\n");
    let output = cluster.run(&[]);
    let said = told(&output);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        said.contains("no job was accepted: `sbatch` says: sbatch: error: invalid partition specified: shrot"),
        "{said}"
    );
    std::fs::remove_file(cluster.0.path("refuse")).unwrap();
    cluster.0.write("most", "3\n");
    let output = cluster.run(&[]);
    assert!(output.status.success(), "{}", told(&output));
    assert!(told(&output).contains("3 workers for 6 tasks"), "{}", told(&output));
    let unknown = cluster.0.flow(&["run", "w.toml", "--executor", "slurm", "--site", "nowhere.toml"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(told(&unknown).contains("`flow site new NAME` writes one to fill in"), "{}", told(&unknown));
}

#[test]
fn any_scheduler_with_three_commands_will_do() {
    let site = "workers = 2\nscheduler = \"commands\"\n[commands]\nsubmit = [\"sbatch\", \"{script}\"]\n\
                alive = [\"squeue\", \"--name={name}\"]\ncancel = [\"scancel\", \"--name={name}\"]\n\
                index = \"$SLURM_ARRAY_TASK_ID\"\n\
                header = [\"#SBATCH --array=0-{last}\", \"#SBATCH --output={log}\", \"#SBATCH --job-name={name}\"]\n";
    let cluster = Cluster::new(6, "sleep 0.1", site);
    let output = cluster.run(&[]);
    assert!(output.status.success(), "{}", told(&output));
    assert_eq!(cluster.computed(), (1..=6).collect::<Vec<_>>());
}

#[test]
fn a_worker_ends_in_time_and_the_next_one_goes_on() {
    let cluster = Cluster::new(8, "sleep 0.5", "workers = 1");
    cluster.0.write("hold", "");
    let first = cluster.start();
    cluster.until("the job is submitted", || cluster.0.path("job").is_file());
    cluster.until("its number is noted", || {
        queue(&cluster.0).is_some_and(|queue| queue.join("round-0001.json").is_file())
    });
    signal(&first, Signal::TERM);
    first.wait_with_output().unwrap();
    let queue = queue(&cluster.0).unwrap();
    let script = std::fs::read_to_string(queue.join("job-1.sh")).unwrap();
    let secret = script.lines().find_map(|line| line.strip_prefix("export FLOW_QUEUE_SECRET=")).unwrap();
    let name = queue.file_name().unwrap().to_str().unwrap();
    let work = |seconds: &str| {
        let mut command = cluster.0.command(&["work", name, "--seconds", seconds]);
        let output = command.env("FLOW_QUEUE_SECRET", secret).output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
        told(&output)
    };
    assert!(work("2.5").contains("its time was over"));
    let done = cluster.computed().len();
    assert!((1..8).contains(&done), "{done}");
    assert!(!work("600").contains("its time was over"));
    // What was running when the time was over has been begun, and is for the submitter to list again.
    assert!(cluster.computed().len() >= 7, "{:?}", cluster.computed());
    let mut other = cluster.0.command(&["work", name]);
    let refused = other.env("FLOW_QUEUE_SECRET", "0".repeat(64)).output().unwrap();
    assert!(
        told(&refused).contains("it is not the list that was submitted; nothing in it is run"),
        "{}",
        told(&refused)
    );
    std::fs::remove_file(cluster.0.path("hold")).unwrap();
    let output = cluster.run(&[]);
    assert!(output.status.success(), "{}", told(&output));
    assert_eq!(cluster.computed(), (1..=8).collect::<Vec<_>>());
}

fn queue(space: &Space) -> Option<std::path::PathBuf> {
    Some(std::fs::read_dir(space.path("store/queue")).ok()?.next()?.ok()?.path())
}

#[test]
fn what_would_be_submitted_is_shown_as_text() {
    let cluster = Cluster::new(6, "sleep 0.1", "workers = 4\npartition = \"short\"\n[stage.rows]\nmemory = \"3 GB\"");
    cluster.0.stdout(&["run", "w.toml", "grid", "--quiet"]);
    let output = cluster.run(&["--dry-run"]);
    let said = told(&output);
    assert!(said.contains("ready: 6 tasks for 4 workers"), "{said}");
    assert!(said.contains("#SBATCH --array=0-3") && said.contains("#SBATCH --mem=2862M"), "{said}");
    assert_eq!(cluster.calls("sbatch"), 0);
    assert!(!Path::new(&cluster.0.path("store/queue")).exists());
}
