//! Signatures of segments by SSH keys, as git has them: who pushed a segment.
//!
//! OpenSSH's own `ssh-keygen -Y` signs and verifies. So keys in an agent and on hardware tokens work, a list of allowed
//! signers means what it means to ssh and git (validity, certificates, namespaces), and no second reader of keys can
//! disagree with it.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The namespace of the signatures, so that a signature of another kind of file is not taken for one of a segment.
const NAMESPACE: &str = "flow-store";

/// How a push is signed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Signing {
    /// With this key: a private key, or a public one whose private part an agent has.
    Key(PathBuf),
    /// Unsigned.
    None,
}

/// The signers whose segments are taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trust {
    /// Those of the signers in this file, in the format of `ssh-keygen`'s allowed signers.
    Signers(PathBuf),
    /// Any segment, signed or not.
    Anybody,
}

impl Signing {
    /// The signature of these bytes; `None` when the push is unsigned.
    pub(super) fn sign(&self, bytes: &[u8]) -> Result<Option<Vec<u8>>, String> {
        let Self::Key(key) = self else { return Ok(None) };
        let mut command = Command::new("ssh-keygen");
        command.args(["-Y", "sign", "-n", NAMESPACE, "-f"]).arg(key);
        run(command, bytes).map(Some).map_err(|(Trouble::NotRun(why) | Trouble::Said(why))| why)
    }
}

impl Trust {
    /// The principal who signed these bytes.
    pub(super) fn signer(&self, bytes: &[u8], signature: Option<&[u8]>) -> Result<String, String> {
        let file = match self {
            Self::Anybody => return Ok("anybody".to_owned()),
            Self::Signers(file) => file,
        };
        let signature = signature.ok_or("it is not signed; `--unsigned` takes it all the same")?;
        let mut kept = tempfile::NamedTempFile::new().map_err(|error| error.to_string())?;
        kept.write_all(signature).map_err(|error| error.to_string())?;
        let mut find = Command::new("ssh-keygen");
        find.args(["-Y", "find-principals", "-f"]).arg(file).arg("-s").arg(kept.path());
        let unknown = |why| match why {
            Trouble::NotRun(why) => why,
            Trouble::Said(_) => format!("its signer is not in {}", file.display()),
        };
        let found = run(find, bytes).map_err(unknown)?;
        let found = String::from_utf8_lossy(&found).into_owned();
        let principal = found.lines().next().unwrap_or_default().split(',').next().unwrap_or_default().trim();
        let mut verify = Command::new("ssh-keygen");
        verify.args(["-Y", "verify", "-n", NAMESPACE, "-I", principal, "-f"]).arg(file).arg("-s").arg(kept.path());
        let unfit = |why| match why {
            Trouble::NotRun(why) => why,
            Trouble::Said(why) => format!("the signature of {principal} does not fit it ({why})"),
        };
        run(verify, bytes).map_err(unfit)?;
        Ok(principal.to_owned())
    }
}

/// Why a program gave no output.
enum Trouble {
    /// It could not be run.
    NotRun(String),
    /// It failed with this last line on standard error.
    Said(String),
}

/// Runs a program with these bytes on standard input and returns its output.
fn run(mut command: Command, bytes: &[u8]) -> Result<Vec<u8>, Trouble> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let unrun = |error: std::io::Error| Trouble::NotRun(format!("`ssh-keygen` of OpenSSH cannot be run: {error}"));
    let mut child = command.spawn().map_err(unrun)?;
    let written = child.stdin.take().map(|mut input| input.write_all(bytes));
    let output = child.wait_with_output().map_err(unrun)?;
    if output.status.success() {
        // The program may end before it has read all.
        let _ = written;
        return Ok(output.stdout);
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let last = said.lines().rev().find(|line| !line.trim().is_empty());
    Err(Trouble::Said(last.unwrap_or("it gave no reason").trim().to_owned()))
}
