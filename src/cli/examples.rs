//! Examples below the help of each command. A test reads every line as a command line.

pub(super) const RUN: &str = "Examples:
  flow run w.toml
      everything that is missing
  flow run w.toml anova --profile quick
      one stage with all it needs, by the small profile
  flow run w.toml --set stage.anova.alpha=0.01
      with one value changed; only what depends on it runs
  flow run w.toml --executor slurm --site ours
      on the cluster that `flow site new ours` has described";

pub(super) const PLAN: &str = "Examples:
  flow plan w.toml
      what would run, why, and for how long
  flow plan w.toml --set stage.anova.alpha=0.01
      what an edit would run";

pub(super) const SHOW: &str = "Examples:
  flow show w.toml
      the stages and the names of their tables
  flow show w.toml anova --table anova --csv
      a table, as CSV
  flow show w.toml 'orthogonal[12]' --json
      one run of a design, row 12";

pub(super) const CALIBRATE: &str = "Examples:
  flow calibrate w.toml --target UCS='30 MPa' --target E='26 GPa'
  flow calibrate w.toml --target nu=0.2 --verify
      and simulate the solution on fresh specimens
  flow calibrate w.toml --page calibrator.html
      a page for people without flow";

pub(super) const CHECK: &str = "Examples:
  flow check w.toml
      every fault at once, with line, column and remedy
  flow check w.toml --json
      the same for an editor";

pub(super) const GRAPH: &str = "Examples:
  flow graph w.toml
      a line for each stage
  flow graph w.toml --format svg > stages.svg
      a picture";

pub(super) const REPORT: &str = "Examples:
  flow report w.toml
      report.html
  flow report w.toml --profile quick -o quick.html";

pub(super) const EXPORT: &str = "Examples:
  flow export w.toml
      pictures and tables of every stage, in export/
  flow export w.toml anova --to csv --folder tables
  flow export w.toml specimen trial --to vtu
      for ParaView
  flow export w.toml 'trial[3]' --to particles
      lists of particles for another code";

pub(super) const DIFF: &str = "Examples:
  flow diff w.toml@quick w.toml
      a profile against the whole campaign
  flow diff '#3' w.toml
      the recorded run 3 against the file as it is";

pub(super) const STORE: &str = "Examples:
  flow store du
      what the results take
  flow store gc w.toml
      what no stage of w.toml can reach; --yes removes it
  flow store verify
      every result against its record
  flow store push results/rocks --sign ~/.ssh/id_ed25519
      the results for colleagues, signed
  flow store pull results/rocks
      their results, proven before they are used";

pub(super) const SITE: &str = "Examples:
  flow site new ours
      a commented site file to fill in
  flow site check ours
      the script that it makes";

pub(super) const STORE_LS: &str = "Examples:
  flow store ls
  flow store ls --store results
      another folder than the usual one";

pub(super) const STORE_ADOPT: &str = "Example:
  flow store adopt --store results
      results of an earlier flow, to be used by this one";

pub(super) const STORE_VERIFY: &str = "Example:
  flow store verify
      every result against its record; 1 if any is damaged";

pub(super) const STORE_DU: &str = "Example:
  flow store du
      what the results of each kind take";

pub(super) const STORE_GC: &str = "Examples:
  flow store gc w.toml
      lists what no stage of w.toml can reach
  flow store gc w.toml other.toml --yes
      removes what neither can reach";

pub(super) const STORE_PUSH: &str = "Examples:
  flow store push results/rocks --sign ~/.ssh/id_ed25519
      a folder that others can read, signed
  flow store push s3://rocks/c30 --unsigned
      a bucket, for people who trust its server";

pub(super) const STORE_PULL: &str = "Examples:
  flow store pull results/rocks
      results of the people in allowed_signers, proven first
  flow store pull s3://rocks/c30 --unsigned
      of anybody";

pub(super) const STORE_ATTACH: &str = "Example:
  flow store attach results/rocks
      each result is read from there when it is first needed";

pub(super) const STORE_DETACH: &str = "Example:
  flow store detach
      what was read stays";

pub(super) const STORE_MIRROR: &str = "Example:
  flow store mirror results/rocks s3://rocks/c30
      a folder into a bucket, with its signatures";

pub(super) const STORE_AUDIT: &str = "Example:
  flow store audit w.toml --sample 5
      five results computed again, compared bit by bit";

pub(super) const SITE_LS: &str = "Example:
  flow site ls
      the site files, and where they lie";

pub(super) const SITE_NEW: &str = "Examples:
  flow site new ours
      ours.toml in the folder of site files; fill in queue, account and modules
  flow run w.toml --executor slurm --site ours
      then runs on it";

pub(super) const SITE_CHECK: &str = "Example:
  flow site check ours
      the script that would be submitted";

pub(super) const SITE_SCHEMA: &str = "Example:
  flow site schema > site.schema.json
      editors complete and check with it";

pub(super) const NEW: &str = "Examples:
  flow new mine
      mine.toml, a first campaign
  flow new core --from rock-3d
      a rock core in space";

pub(super) const SCHEMA: &str = "Example:
  flow schema > flow.schema.json
      editors complete and check with it";

pub(super) const COMPLETIONS: &str = "Example:
  flow completions bash > ~/.local/share/bash-completion/completions/flow";

#[cfg(test)]
mod tests {
    use super::super::Arguments;
    use clap::{CommandFactory, Parser};

    /// The words of an example, without quotation marks and redirection.
    fn words(line: &str) -> Vec<String> {
        let command = line.trim_start().split(" > ").next().unwrap_or_default();
        let (mut words, mut quoted) = (vec![String::new()], false);
        for letter in command.chars() {
            match letter {
                '\'' => quoted = !quoted,
                ' ' if !quoted => words.push(String::new()),
                other => words.last_mut().expect("one word at least").push(other),
            }
        }
        words
    }

    /// The commands that people see, each with the words that call it.
    fn all(command: &clap::Command, call: &[String]) -> Vec<(Vec<String>, clap::Command)> {
        let seen = command.get_subcommands().filter(|command| !command.is_hide_set() && command.get_name() != "help");
        let one = |command: &clap::Command| {
            let call = [call, &[command.get_name().to_owned()]].concat();
            let below = all(command, &call);
            [vec![(call, command.clone())], below].concat()
        };
        seen.flat_map(one).collect()
    }

    #[test]
    fn every_command_has_examples_that_it_takes() {
        for (call, command) in all(&Arguments::command(), &["flow".to_owned()]) {
            let name = call.join(" ");
            let help = command.get_after_help().unwrap_or_else(|| panic!("`{name}` has no example")).to_string();
            let lines: Vec<&str> = help.lines().filter(|line| line.starts_with("  flow ")).collect();
            assert!(!lines.is_empty(), "`{name}`: {help}");
            assert!(words(lines[0]).starts_with(&call), "{}", lines[0]);
            for line in lines {
                let read = Arguments::try_parse_from(words(line));
                assert!(read.is_ok(), "{line}: {}", read.err().map_or_else(String::new, |e| e.to_string()));
            }
        }
    }
}
