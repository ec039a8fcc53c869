//! The text of a job script: a pure function of the site and of what is asked for, so that it can be shown and tested as text.

use super::site::{Kind, Needs, Site};
use std::path::Path;

/// What one submission asks for.
pub struct Order<'a> {
    /// The site.
    pub site: &'a Site,
    /// What each worker is given.
    pub needs: &'a Needs,
    /// Name of the queue.
    pub queue: &'a str,
    /// Folder of the queue, where the workers' output goes.
    pub folder: &'a Path,
    /// The store.
    pub store: &'a Path,
    /// The program that the workers are, where the site names none.
    pub program: &'a Path,
    /// What lets the workers believe the lists.
    pub secret: &'a str,
    /// Which submission of the queue this is, from 1.
    pub round: usize,
    /// How many workers.
    pub workers: usize,
}

/// Name of the jobs of a queue.
pub fn job_name(queue: &str) -> String {
    format!("flow-{queue}")
}

/// Name of the file that a worker's output goes to; `round` and `index` as in its report.
pub fn log_name(round: usize, index: &str) -> String {
    format!("log-{round}-{index}.txt")
}

/// The variable that hands the secret of a queue to its workers.
pub const SECRET: &str = "FLOW_QUEUE_SECRET";

/// The script that starts each of the workers.
pub fn script(order: &Order) -> String {
    // A login shell: on many clusters the command `module` is there in such shells only.
    let mut lines = vec!["#!/bin/bash -l".to_owned()];
    let index = match (&order.site.scheduler, &order.site.commands) {
        (Kind::Commands, Some(commands)) => {
            lines.extend(commands.header.iter().map(|line| filled(line, order)));
            commands.index.clone()
        }
        (Kind::Slurm | Kind::Commands, _) => {
            lines.extend(slurm_options(order).iter().map(|option| format!("#SBATCH {option}")));
            "$SLURM_ARRAY_TASK_ID".to_owned()
        }
    };
    lines.extend(order.site.setup.iter().cloned());
    lines.push(format!("export {SECRET}={}", order.secret));
    let program = order.site.flow.as_deref().unwrap_or(order.program);
    let mut command = format!(
        "exec {} work {} --store {} --round {} --index \"{index}\" --of {} --cpus {} --linger {}",
        quoted(program),
        order.queue,
        quoted(order.store),
        order.round,
        order.workers,
        order.needs.cpus,
        order.site.linger.get(),
    );
    if let Some(time) = order.needs.time {
        command.push_str(&format!(" --seconds {}", time.get()));
    }
    if order.needs.alone {
        command.push_str(" --alone");
    }
    lines.push(command);
    lines.join("\n") + "\n"
}

fn slurm_options(order: &Order) -> Vec<String> {
    let needs = order.needs;
    let log = order.folder.join(log_name(order.round, "%a"));
    let mut options = vec![
        format!("--job-name={}", job_name(order.queue)),
        format!("--array=0-{}", order.workers - 1),
        format!("--output={}", log.display()),
        // Flow itself begins again what a lost worker had begun.
        "--no-requeue".to_owned(),
        format!("--cpus-per-task={}", needs.cpus),
    ];
    options.extend(needs.partition.iter().map(|name| format!("--partition={name}")));
    options.extend(order.site.account.iter().map(|name| format!("--account={name}")));
    // Slurm's M are 2²⁰ bytes.
    options.extend(needs.memory.map(|memory| format!("--mem={}M", (memory.0 * 1_000_000).div_ceil(1 << 20))));
    options.extend(needs.time.map(|time| format!("--time={}", clock(time.get()))));
    options.extend(needs.options.iter().cloned());
    options
}

/// Seconds as Slurm writes a time, rounded up to minutes: `days-hours:minutes:00`.
fn clock(seconds: f64) -> String {
    let minutes = (seconds / 60.0).ceil() as u64;
    format!("{}-{:02}:{:02}:00", minutes / 1440, minutes / 60 % 24, minutes % 60)
}

/// A text of `[commands]` with the words in braces replaced.
pub fn filled(text: &str, order: &Order) -> String {
    let needs = order.needs;
    let pairs = [
        ("{name}", job_name(order.queue)),
        ("{workers}", order.workers.to_string()),
        ("{last}", (order.workers - 1).to_string()),
        ("{log}", order.folder.join(log_name(order.round, "all")).display().to_string()),
        ("{script}", order.folder.join(format!("job-{}.sh", order.round)).display().to_string()),
        ("{memory}", needs.memory.map_or_else(String::new, |memory| memory.0.to_string())),
        ("{cpus}", needs.cpus.to_string()),
        ("{seconds}", needs.time.map_or_else(String::new, |time| time.get().to_string())),
    ];
    pairs.iter().fold(text.to_owned(), |text, (word, value)| text.replace(word, value))
}

/// A path as one word for a shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.display().to_string().replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(site: &str, workers: usize) -> String {
        let site = Site::parse(site).unwrap();
        script(&Order {
            site: &site,
            needs: &site.needs("rows"),
            queue: "20260101-1",
            folder: Path::new("/s/queue/20260101-1"),
            store: Path::new("/home/o'hara/store"),
            program: Path::new("/opt/flow"),
            secret: "abc",
            round: 2,
            workers,
        })
    }

    #[test]
    fn the_script_for_slurm_asks_for_what_the_site_says() {
        let site = "partition = \"short\"\naccount = \"rock\"\ncpus = 4\nmemory = \"2 GB\"\ntime = \"90 min\"\n\
                    setup = [\"module load gcc\"]\noptions = [\"--qos=normal\"]";
        assert_eq!(
            text(site, 16),
            "#!/bin/bash -l\n\
             #SBATCH --job-name=flow-20260101-1\n\
             #SBATCH --array=0-15\n\
             #SBATCH --output=/s/queue/20260101-1/log-2-%a.txt\n\
             #SBATCH --no-requeue\n\
             #SBATCH --cpus-per-task=4\n\
             #SBATCH --partition=short\n\
             #SBATCH --account=rock\n\
             #SBATCH --mem=1908M\n\
             #SBATCH --time=0-01:30:00\n\
             #SBATCH --qos=normal\n\
             module load gcc\n\
             export FLOW_QUEUE_SECRET=abc\n\
             exec '/opt/flow' work 20260101-1 --store '/home/o'\\''hara/store' --round 2 --index \"$SLURM_ARRAY_TASK_ID\" \
             --of 16 --cpus 4 --linger 30 --seconds 5400\n"
        );
    }

    #[test]
    fn other_schedulers_have_their_own_header_and_index() {
        let site = "scheduler = \"commands\"\nflow = \"/sw/flow\"\n[commands]\nsubmit = [\"qsub\", \"{script}\"]\n\
                    alive = [\"qstat\"]\ncancel = [\"qdel\", \"{jobs}\"]\nindex = \"$PBS_ARRAY_INDEX\"\n\
                    header = [\"#PBS -N {name}\", \"#PBS -J 0-{last}\", \"#PBS -o {log}\"]";
        let text = text(site, 3);
        assert!(text.contains("#PBS -N flow-20260101-1\n#PBS -J 0-2\n#PBS -o /s/queue/20260101-1/log-2-all.txt\n"));
        assert!(text.contains("exec '/sw/flow' work") && text.contains("--index \"$PBS_ARRAY_INDEX\""), "{text}");
        assert!(!text.contains("SBATCH"));
    }

    #[test]
    fn times_are_written_as_slurm_reads_them() {
        assert_eq!(
            ["30", "3600", "90061", "864000"].map(|s| clock(s.parse().unwrap())),
            ["0-00:01:00", "0-01:00:00", "1-01:02:00", "10-00:00:00"]
        );
    }
}
