//! Schedulers: three questions, each answered by running one program.

use super::script::{self, Order};
use super::site::{Commands, Kind, Site};
use std::collections::HashMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The three questions to a scheduler.
pub trait Scheduler: Send + Sync {
    /// Submits an array of equal jobs, whose script is in the folder of the queue; returns the number of the job.
    ///
    /// # Errors
    /// The scheduler refuses, for the reason in its own words.
    fn submit(&self, order: &Order) -> Result<String, String>;

    /// Which of these jobs, and of the jobs of this queue, wait or run.
    ///
    /// # Errors
    /// The scheduler does not answer, which says nothing about the jobs.
    fn alive(&self, queue: &str, jobs: &[String]) -> Result<Alive, String>;

    /// Cancels the jobs of a queue.
    ///
    /// # Errors
    /// The scheduler refuses.
    fn cancel(&self, queue: &str, jobs: &[String]) -> Result<(), String>;
}

/// Jobs that wait or run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Alive {
    /// By job: the indices of its array that wait or run, where the scheduler lists them one by one.
    pub jobs: HashMap<String, Option<Vec<usize>>>,
    /// How many wait for a free node, and why the first of them does.
    pub waiting: Option<(usize, String)>,
}

/// The scheduler of a site.
pub fn of(site: &Site) -> Box<dyn Scheduler> {
    match (site.scheduler, &site.commands) {
        (Kind::Commands, Some(commands)) => Box::new(Generic(commands.clone())),
        (Kind::Slurm | Kind::Commands, _) => Box::new(Slurm),
    }
}

/// The programs that a site's scheduler is spoken to with and that are not there.
pub fn missing(site: &Site) -> Vec<String> {
    let programs: Vec<String> = match (site.scheduler, &site.commands) {
        (Kind::Commands, Some(Commands { submit, alive, cancel, .. })) => {
            [submit, alive, cancel].into_iter().filter_map(|command| command.first().cloned()).collect()
        }
        (Kind::Slurm | Kind::Commands, _) => words(&["sbatch", "squeue", "scancel"]),
    };
    let path = std::env::var_os("PATH").unwrap_or_default();
    let is_there = |program: &String| match program.contains('/') {
        true => Path::new(program).is_file(),
        false => std::env::split_paths(&path).any(|folder| folder.join(program).is_file()),
    };
    programs.into_iter().filter(|program| !is_there(program)).collect()
}

/// Longest wait for an answer of a scheduler.
const PATIENCE: Duration = Duration::from_secs(120);

/// Runs a program to its end; returns its output, or why there is none.
fn run(words: &[String]) -> Result<String, String> {
    let [program, arguments @ ..] = words else { return Err("no program".to_owned()) };
    let unread = |error: std::io::Error| format!("the answer of `{program}` cannot be read: {error}");
    // Files in memory take any length, and nobody must read them meanwhile.
    let (mut out, mut err) = (in_memory().map_err(unread)?, in_memory().map_err(unread)?);
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null());
    command.stdout(out.try_clone().map_err(unread)?).stderr(err.try_clone().map_err(unread)?);
    // Ctrl-C in a terminal reaches the whole group; cancelling must still be done then.
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn().map_err(|error| format!("`{program}` cannot be run: {error}"))?;
    let started = Instant::now();
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if started.elapsed() > PATIENCE => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("`{program}` does not answer"));
            }
            Ok(None) => std::thread::sleep(Duration::from_millis(5)),
            Err(error) => return Err(format!("`{program}`: {error}")),
        }
    };
    let stdout = text(&mut out).map_err(unread)?;
    if status.success() {
        return Ok(stdout);
    }
    let answer = [text(&mut err).map_err(unread)?, stdout].into_iter().find(|text| !text.is_empty());
    let answer = answer.unwrap_or_else(|| status.to_string());
    Err(format!("`{program}` says: {}", answer.lines().collect::<Vec<_>>().join("; ")))
}

/// A file in memory.
fn in_memory() -> std::io::Result<File> {
    Ok(rustix::fs::memfd_create("flow", rustix::fs::MemfdFlags::CLOEXEC)?.into())
}

/// What was written into a file.
fn text(file: &mut File) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).trim().to_owned())
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

struct Slurm;

impl Scheduler for Slurm {
    fn submit(&self, order: &Order) -> Result<String, String> {
        let script = order.folder.join(format!("job-{}.sh", order.round)).display().to_string();
        let answer = run(&words(&["sbatch", "--parsable", &script]))?;
        // On some sites the name of a cluster follows the number.
        let job: String = answer.lines().last().unwrap_or_default().chars().take_while(char::is_ascii_digit).collect();
        if job.is_empty() { Err(format!("`sbatch` says no number of a job: {answer}")) } else { Ok(job) }
    }

    fn alive(&self, queue: &str, _: &[String]) -> Result<Alive, String> {
        let user = rustix::process::getuid().as_raw();
        let (name, user) = (format!("--name={}", script::job_name(queue)), format!("--user={user}"));
        run(&words(&["squeue", "--noheader", "--array", &name, &user, "--format=%F %K %T %r"]))
            .map(|text| listed(&text))
    }

    fn cancel(&self, queue: &str, jobs: &[String]) -> Result<(), String> {
        let user = rustix::process::getuid().as_raw();
        let (name, user) = (format!("--name={}", script::job_name(queue)), format!("--user={user}"));
        let named = run(&words(&["scancel", "--quiet", &name, &user])).map(|_| ());
        if named.is_ok() || jobs.is_empty() {
            return named;
        }
        run(&[words(&["scancel", "--quiet"]), jobs.to_vec()].concat()).map(|_| ())
    }
}

/// What `squeue` lists: job, number in the array, state, reason.
fn listed(text: &str) -> Alive {
    let mut alive = Alive::default();
    for line in text.lines() {
        let mut parts = line.split_whitespace();
        let (Some(job), Some(index), Some(state)) = (parts.next(), parts.next(), parts.next()) else { continue };
        // Jobs that are ending begin no more tasks, so they do not count.
        let waits = matches!(state, "PENDING" | "CONFIGURING" | "REQUEUED" | "SUSPENDED" | "REQUEUE_HOLD");
        if !waits && state != "RUNNING" {
            continue;
        }
        let indices = alive.jobs.entry(job.to_owned()).or_insert_with(|| Some(Vec::new()));
        match (index.parse(), indices) {
            (Ok(index), Some(indices)) => indices.push(index),
            (_, indices) => *indices = None,
        }
        if waits {
            let why = parts.collect::<Vec<_>>().join(" ");
            alive.waiting.get_or_insert((0, why)).0 += 1;
        }
    }
    alive
}

/// A scheduler that is driven by the commands of the site file.
struct Generic(Commands);

impl Generic {
    fn with_jobs(command: &[String], queue: &str, jobs: &[String]) -> Vec<String> {
        let user = std::env::var("USER").unwrap_or_default();
        let name = script::job_name(queue);
        let replaced = |word: &String| match word.as_str() {
            "{jobs}" => jobs.to_vec(),
            word => vec![word.replace("{user}", &user).replace("{name}", &name)],
        };
        command.iter().flat_map(replaced).collect()
    }
}

impl Scheduler for Generic {
    fn submit(&self, order: &Order) -> Result<String, String> {
        let command: Vec<String> = self.0.submit.iter().map(|word| script::filled(word, order)).collect();
        let answer = run(&command)?;
        let pattern = regex_lite::Regex::new(&self.0.job).map_err(|error| error.to_string())?;
        let found = pattern.find(&answer).map(|found| found.as_str().to_owned());
        found.ok_or_else(|| format!("`{}` says no job that `commands.job` finds: {answer}", command[0]))
    }

    fn alive(&self, queue: &str, jobs: &[String]) -> Result<Alive, String> {
        let answer = run(&Self::with_jobs(&self.0.alive, queue, jobs))?;
        let numbers: std::collections::HashSet<&str> = answer.split(|c: char| !c.is_ascii_digit()).collect();
        let number =
            |job: &str| job.split(|c: char| !c.is_ascii_digit()).find(|part| !part.is_empty()).map(str::to_owned);
        let there = jobs.iter().filter(|job| number(job).is_some_and(|number| numbers.contains(number.as_str())));
        Ok(Alive { jobs: there.map(|job| (job.clone(), None)).collect(), waiting: None })
    }

    fn cancel(&self, queue: &str, jobs: &[String]) -> Result<(), String> {
        if jobs.is_empty() {
            return Ok(());
        }
        run(&Self::with_jobs(&self.0.cancel, queue, jobs)).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_of_slurm_says_who_is_there_and_who_waits() {
        let text = "12 0 RUNNING None\n12 3 PENDING Priority\n12 4 PENDING Priority\n12 5 COMPLETING None\n\
                    13 N/A RUNNING None\n14 1 FAILED NonZeroExitCode\n";
        let alive = listed(text);
        assert_eq!(alive.jobs["12"], Some(vec![0, 3, 4]));
        assert_eq!(alive.jobs["13"], None);
        assert!(!alive.jobs.contains_key("14"));
        assert_eq!(alive.waiting, Some((2, "Priority".to_owned())));
    }

    #[test]
    fn other_schedulers_name_a_job_in_their_own_words() {
        let answers = |submitted: &str, listing: &str, job: &str| {
            let commands = Commands {
                submit: words(&["echo", submitted]),
                alive: words(&["echo", listing]),
                cancel: words(&["true", "{jobs}"]),
                job: job.to_owned(),
                header: Vec::new(),
                index: "$I".to_owned(),
            };
            let site = Site::default();
            let order = Order {
                site: &site,
                needs: &site.needs("a"),
                queue: "q",
                folder: std::path::Path::new("/q"),
                store: std::path::Path::new("/s"),
                program: std::path::Path::new("/f"),
                secret: "",
                round: 1,
                workers: 2,
            };
            let generic = Generic(commands);
            let job = generic.submit(&order)?;
            let alive = generic.alive("q", std::slice::from_ref(&job))?.jobs.contains_key(&job);
            Ok::<_, String>((job, alive))
        };
        let pbs = answers("1234[].server", "1234[1].server flow-q me 0 R workq", r"\d+\[\]\.\w+");
        assert_eq!(pbs, Ok(("1234[].server".to_owned(), true)));
        let lsf = answers("Job <77> is submitted to queue <normal>.", "JOBID USER\n177 me RUN", r"\d+");
        assert_eq!(lsf, Ok(("77".to_owned(), false)));
        let sge = answers("Your job-array 9.1-10:1 (\"flow\") has been submitted", "  9 0.5 flow me qw 1,2", r"\d+");
        assert_eq!(sge, Ok(("9".to_owned(), true)));
        assert!(answers("no", "", r"\d+").unwrap_err().contains("says no job"));
    }

    #[test]
    fn a_refusal_is_told_in_the_words_of_the_scheduler() {
        let refused = run(&words(&["sh", "-c", "echo 'error: QOSMaxSubmitJobPerUserLimit' >&2; exit 1"]));
        assert_eq!(refused, Err("`sh` says: error: QOSMaxSubmitJobPerUserLimit".to_owned()));
        assert!(run(&words(&["flow-no-such-program"])).unwrap_err().contains("cannot be run"));
    }

    #[test]
    fn an_answer_longer_than_a_pipe_is_read_whole() {
        let long = run(&words(&["sh", "-c", "head -c 300000 /dev/zero | tr '\\0' x; echo warning >&2"])).unwrap();
        assert!(long.len() == 300_000 && long.bytes().all(|byte| byte == b'x'), "{} bytes", long.len());
    }
}
