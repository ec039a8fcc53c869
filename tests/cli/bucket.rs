//! A campaign that travels through a bucket: servers that others wrote, moto and rclone, on this machine.

use crate::space::{Space, told};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A server with an empty bucket `lab`.
struct Server {
    process: Child,
    port: u16,
    log: std::path::PathBuf,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Server {
    /// Starts a program whose arguments name the port `{port}`; none when it is not installed and need not be.
    fn start(space: &Space, program: &str, arguments: &[&str]) -> Option<Self> {
        let there = Command::new(program).arg("--help").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if there.is_err() {
            assert!(std::env::var("FLOW_TEST_READERS").is_err(), "{program} is not installed: .ci/install");
            return None;
        }
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let log = space.path("server.log");
        let file = std::fs::File::create(&log).unwrap();
        let arguments = arguments.iter().map(|word| word.replace("{port}", &port.to_string()));
        let mut command = Command::new(program);
        command.args(arguments).stdout(file.try_clone().unwrap()).stderr(file).stdin(Stdio::null());
        let server = Self { process: command.spawn().unwrap(), port, log };
        let since = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(since.elapsed() < Duration::from_secs(120), "{program} does not come up");
            std::thread::sleep(Duration::from_millis(100));
        }
        Some(server)
    }

    /// Moto, which notes every request. It checks no signatures.
    fn moto(space: &Space) -> Option<Self> {
        let server = Self::start(space, "moto_server", &["-H", "127.0.0.1", "-p", "{port}"])?;
        let mut stream = TcpStream::connect(("127.0.0.1", server.port)).unwrap();
        let authority = "authorization: AWS4-HMAC-SHA256 Credential=KEY/20260101/us-east-1/s3/aws4_request, \
                         SignedHeaders=host, Signature=0";
        write!(
            stream,
            "PUT /lab HTTP/1.1\r\nhost: 127.0.0.1\r\n{authority}\r\nconnection: close\r\ncontent-length: 0\r\n\r\n"
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.contains(" 200 "), "{answer}");
        Some(server)
    }

    /// Rclone, which checks signatures and knows no conditions.
    fn rclone(space: &Space) -> Option<Self> {
        std::fs::create_dir_all(space.path("served/lab")).unwrap();
        let folder = space.path("served").display().to_string();
        let arguments = ["serve", "s3", "--auth-key", "KEY,secret", "--addr", "127.0.0.1:{port}", &folder];
        Self::start(space, "rclone", &arguments)
    }

    /// Requests that moto has answered so far.
    fn requests(&self) -> Vec<String> {
        let log = std::fs::read_to_string(&self.log).unwrap();
        log.lines().filter(|line| line.contains(" HTTP/1.1")).map(str::to_owned).collect()
    }

    fn command(&self, space: &Space, secret: &str, arguments: &[&str]) -> Command {
        let mut command = space.command(arguments);
        command.env("AWS_ACCESS_KEY_ID", "KEY").env("AWS_SECRET_ACCESS_KEY", secret);
        command.env("AWS_ENDPOINT_URL", format!("http://127.0.0.1:{}", self.port));
        command.env_remove("AWS_PROFILE").env_remove("AWS_REGION").env("HOME", space.path("home"));
        command
    }

    fn flow(&self, space: &Space, secret: &str, arguments: &[&str]) -> (bool, String) {
        let output = self.command(space, secret, arguments).output().unwrap();
        (output.status.success(), told(&output))
    }

    fn good(&self, space: &Space, arguments: &[&str]) -> String {
        let (good, text) = self.flow(space, "secret", arguments);
        assert!(good, "{text}");
        text
    }
}

/// A campaign of 40 cheap tasks in the store `ours`, and the count of those that ran.
fn campaign(space: &Space) -> impl Fn() -> usize {
    let levels: Vec<String> = (1..=40).map(|level| level.to_string()).collect();
    let log = space.path("log").display().to_string();
    space.write("in.txt", "{{a}}\n");
    let text = format!(
        "[workflow]\nseed = 1\n[factor]\na = {{ sets = \"m.a\", levels = [{}] }}\n[response]\ny = {{}}\n[material.base]\n\
         m = {{ a = 1 }}\n[stage.grid]\nkind = \"design\"\nmethod = \"full-factorial\"\nfactors = [\"a\"]\n[stage.rows]\n\
         kind = \"command\"\ndesign = \"grid\"\nmaterial = \"base\"\nrun = [\"sh\", \"-c\", \"echo x >>{log}; echo v=$(cat in)\"]\n\
         templates = {{ \"in\" = \"in.txt\" }}\nread.y = {{ file = \"stdout\", pattern = 'v=(\\d+)' }}\n",
        levels.join(", ")
    );
    space.write("w.toml", &text);
    std::fs::create_dir_all(space.path("home")).unwrap();
    move || std::fs::read_to_string(&log).unwrap_or_default().lines().count()
}

#[test]
fn a_second_push_asks_twice_at_most_and_a_pulled_campaign_runs_nothing() {
    let space = Space::new();
    let runs = campaign(&space);
    let Some(server) = Server::moto(&space) else { return };
    let key = space.path("key").display().to_string();
    let made = Command::new("ssh-keygen").args(["-q", "-t", "ed25519", "-N", "", "-f", &key]).status();
    assert!(made.expect("OpenSSH").success());
    let public = std::fs::read_to_string(space.path("key.pub")).unwrap();
    space.write("allowed_signers", &format!("ann@lab namespaces=\"flow-store\" {public}"));
    space.run(&["--store", "ours"]);
    let push = ["store", "push", "s3://lab/group", "--sign", "key", "--store", "ours"];
    assert!(server.good(&space, &push).contains("42 results pushed, 0 were there"));
    let before = server.requests().len();
    assert!(server.good(&space, &push).contains("0 results pushed, 42 were there"));
    let second = server.requests().split_off(before);
    assert!(second.len() <= 2, "{second:?}");
    // From another store, which knows nothing of the remote yet.
    server.good(&space, &["run", "w.toml", "--quiet", "--store", "other"]);
    let before = server.requests().len();
    assert!(server.good(&space, &[&push[..6], &["other"]].concat()).contains("0 results pushed, 42 were there"));
    let other = server.requests().split_off(before);
    assert!(other.len() <= 2, "{other:?}");
    let pulled = server.good(&space, &["store", "pull", "s3://lab/group", "--store", "theirs"]);
    assert!(pulled.contains("42 results pulled, 0 were here, 0 refused\n  42 signed by ann@lab"), "{pulled}");
    let ran = runs();
    server.good(&space, &["run", "w.toml", "--store", "theirs"]);
    server.good(&space, &["report", "w.toml", "--store", "theirs"]);
    assert!(server.good(&space, &["show", "w.toml", "rows[2]", "--store", "theirs"]).contains('2'));
    assert_eq!(runs(), ran, "nothing of it was computed");
    // Objects are never listed.
    let listed = |request: &&String| request.contains("list-type=2") && !request.contains("segments");
    assert_eq!(server.requests().iter().filter(listed).count(), 0);
}

#[test]
fn an_attached_bucket_is_read_when_a_result_is_needed() {
    let space = Space::new();
    let runs = campaign(&space);
    let Some(server) = Server::moto(&space) else { return };
    space.run(&["--store", "ours"]);
    server.good(&space, &["store", "push", "s3://lab", "--unsigned", "--store", "ours"]);
    let attached = server.good(&space, &["store", "attach", "s3://lab", "--unsigned", "--store", "theirs"]);
    assert!(attached.contains("s3://lab is attached: 42 results can be read from it"), "{attached}");
    let before = server.requests().len();
    let plan = server.good(&space, &["plan", "w.toml", "--store", "theirs"]);
    assert!(plan.contains("rows  done, 41 cached"), "{plan}");
    let shown = server.good(&space, &["show", "w.toml", "rows[2]", "--store", "theirs"]);
    assert!(shown.contains('2'), "{shown}");
    let asked = server.requests().split_off(before);
    assert!(asked.len() <= 4, "{} requests for one row: {asked:?}", asked.len());
    assert_eq!(runs(), 40, "nothing was computed twice");
    server.good(&space, &["run", "w.toml", "--store", "theirs"]);
    assert_eq!(runs(), 40);
    // If the server cannot be reached, the message says so, and what to do.
    let mut command = space.command(&["show", "w.toml", "rows[7]", "--store", "theirs"]);
    command.env("AWS_ENDPOINT_URL", "http://127.0.0.1:1").env("HOME", space.path("home"));
    let output = command.output().unwrap();
    let text = told(&output);
    assert!(!output.status.success() && text.contains("s3://lab") && text.contains("flow store detach"), "{text}");
    assert!(server.good(&space, &["store", "detach", "--store", "theirs"]).contains("detached"));
}

#[test]
fn a_wrong_secret_is_refused_in_the_servers_words() {
    let space = Space::new();
    let _ = campaign(&space);
    let Some(server) = Server::rclone(&space) else { return };
    space.run(&["--store", "ours"]);
    let push = ["store", "push", "s3://lab/group", "--unsigned", "--store", "ours"];
    let (good, text) = server.flow(&space, "wrong", &push);
    assert!(!good && text.contains("the server says 403"), "{text}");
    assert!(text.contains("see that the credentials are those of this server"), "{text}");
    assert!(server.good(&space, &push).contains("42 results pushed, 0 were there"));
    assert!(server.good(&space, &push).contains("0 results pushed, 42 were there"));
    // A byte that the server has flipped since is refused; the rest is taken.
    let mut objects = Vec::new();
    walk(&space.path("served/lab/group/objects"), &mut objects);
    assert_eq!(objects.len(), 42);
    let mut bytes = std::fs::read(&objects[0]).unwrap();
    bytes[200] ^= 1;
    std::fs::write(&objects[0], bytes).unwrap();
    let (good, text) =
        server.flow(&space, "secret", &["store", "pull", "s3://lab/group", "--unsigned", "--store", "theirs"]);
    assert!(!good && text.contains("41 results pulled, 0 were here, 1 refused"), "{text}");
    assert!(text.contains("its bytes are not those that were written; it is computed again"), "{text}");
    // A mirror copies between a bucket and a folder, and stops at what is damaged.
    let (good, text) = server.flow(&space, "secret", &["store", "mirror", "s3://lab/group", "copy"]);
    assert!(!good && text.contains("of the remote is damaged"), "{text}");
}

fn walk(folder: &std::path::Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.path().is_dir() { walk(&entry.path(), found) } else { found.push(entry.path()) }
    }
}

/// A stack that no memory holds has the system refuse every thread, also to root.
#[test]
fn where_no_thread_can_be_started_objects_are_pushed_and_pulled_one_by_one() {
    let space = Space::new();
    let _ = campaign(&space);
    let Some(server) = Server::moto(&space) else { return };
    space.run(&["--store", "ours"]);
    let starved = |arguments: &[&str]| {
        let mut command = server.command(&space, "secret", arguments);
        let output = command.env("RUST_MIN_STACK", "1000000000000000").output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
        told(&output)
    };
    let pushed = starved(&["store", "push", "s3://lab/group", "--unsigned", "--store", "ours"]);
    assert!(pushed.contains("42 results pushed, 0 were there"), "{pushed}");
    let pulled = starved(&["store", "pull", "s3://lab/group", "--unsigned", "--store", "theirs"]);
    assert!(pulled.contains("42 results pulled, 0 were here, 0 refused"), "{pulled}");
}
