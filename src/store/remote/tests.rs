use super::*;
use crate::artifact::{Artifact, Group, Node};
use crate::store::{Mark, Origin};
use std::path::Path;
use std::process::Command;
use std::time::UNIX_EPOCH;

struct Rig(tempfile::TempDir);

impl Rig {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn store(&self, name: &str) -> Store {
        let mark = Mark::of(blake3::hash(name.as_bytes()).as_bytes());
        Store::open_as(&self.0.path().join(name), mark).unwrap().with_origin(Origin::here)
    }

    fn path(&self) -> std::path::PathBuf {
        self.0.path().join("remote")
    }

    fn remote(&self) -> Address {
        Address::Folder(self.path())
    }

    /// A key, and a list of signers with it.
    fn key(&self, name: &str) -> (Signing, Trust) {
        let (key, list) = (self.0.path().join(name), self.0.path().join(format!("{name}.allowed")));
        let made = Command::new("ssh-keygen").args(["-q", "-t", "ed25519", "-N", "", "-f"]).arg(&key).status();
        assert!(made.unwrap().success());
        let public = std::fs::read_to_string(key.with_extension("pub")).unwrap();
        std::fs::write(&list, format!("{name}@lab namespaces=\"flow-store\" {public}")).unwrap();
        (Signing::Key(key), Trust::Signers(list))
    }

    /// The only file with this ending in the remote.
    fn file(&self, ending: &str) -> std::path::PathBuf {
        fn walk(at: &Path, found: &mut Vec<std::path::PathBuf>) {
            for entry in std::fs::read_dir(at).unwrap().map(|entry| entry.unwrap().path()) {
                if entry.is_dir() { walk(&entry, found) } else { found.push(entry) }
            }
        }
        let mut found = Vec::new();
        walk(&self.path(), &mut found);
        found.retain(|path| path.to_string_lossy().ends_with(ending));
        found.sort();
        found[0].clone()
    }
}

fn put(store: &Store, number: i64) -> Record {
    let root = Group::new().with("n", Node::Int(number));
    let timing = Timing { started: UNIX_EPOCH, seconds: 1.5 };
    store.put(&format!("flow task 1\nwork test {number}\n"), Artifact::new("test", 1, root), &timing).unwrap().0
}

/// Changes a file that may be read only.
fn change(path: &Path, change: impl FnOnce(&mut Vec<u8>)) {
    let mut bytes = std::fs::read(path).unwrap();
    change(&mut bytes);
    std::fs::remove_file(path).unwrap();
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn what_one_store_pushes_another_one_finds_and_nothing_goes_twice() {
    let rig = Rig::new();
    let (ours, theirs) = (rig.store("ours"), rig.store("theirs"));
    let (signing, trust) = rig.key("ann");
    let records: Vec<Record> = (0..3).map(|number| put(&ours, number)).collect();
    let pushed = ours.push(&rig.remote(), &signing).unwrap();
    assert_eq!((pushed.pushed, pushed.there), (3, 0));
    assert_eq!(ours.push(&rig.remote(), &signing).unwrap(), Pushed { pushed: 0, there: 3, segment: None });
    let pulled = theirs.pull(&rig.remote(), &trust).unwrap();
    assert_eq!((pulled.pulled, pulled.here, pulled.refused.len()), (3, 0, 0));
    assert_eq!(pulled.signers, [("ann@lab".to_owned(), 3)].into());
    for record in &records {
        let found = theirs.find(&record.key).unwrap().unwrap();
        assert_eq!((found.content, found.seconds, found.own), (record.content, 1.5, true));
    }
    let again = theirs.pull(&rig.remote(), &trust).unwrap();
    assert_eq!((again.pulled, again.here), (0, 3));
    // A mirror keeps the signatures.
    let copy = Address::Folder(rig.0.path().join("copy"));
    assert_eq!(mirror(&rig.remote(), &copy).unwrap(), Mirrored { segments: 1, objects: 3 });
    assert_eq!(mirror(&rig.remote(), &copy).unwrap(), Mirrored::default());
    assert_eq!(rig.store("third").pull(&copy, &trust).unwrap().pulled, 3);
}

#[test]
fn a_wrong_signer_and_no_signer_are_refused_with_a_word() {
    let rig = Rig::new();
    let (ours, theirs) = (rig.store("ours"), rig.store("theirs"));
    let ((ann, _), (bob, only_bob)) = (rig.key("ann"), rig.key("bob"));
    put(&ours, 1);
    ours.push(&rig.remote(), &ann).unwrap();
    put(&ours, 2);
    ours.push(&rig.remote(), &Signing::None).unwrap();
    let pulled = theirs.pull(&rig.remote(), &only_bob).unwrap();
    assert_eq!((pulled.pulled, pulled.refused.len()), (0, 2));
    let all = pulled.refused.join("\n");
    assert!(all.contains("its signer is not in") && all.contains("it is not signed"), "{all}");
    assert_eq!(theirs.pull(&rig.remote(), &Trust::Anybody).unwrap().pulled, 2);
    // A good signature of something else does not fit.
    std::fs::remove_dir_all(rig.path()).unwrap();
    ours.push(&rig.remote(), &bob).unwrap();
    let other = bob.sign(b"something else").unwrap().unwrap();
    change(&rig.file(".sig"), |bytes| *bytes = other);
    let refused = rig.store("third").pull(&rig.remote(), &only_bob).unwrap().refused;
    assert!(refused[0].contains("the signature of bob@lab does not fit it"), "{refused:?}");
}

#[test]
fn a_flipped_byte_a_torn_push_and_a_forged_record_are_refused() {
    let rig = Rig::new();
    let ours = rig.store("ours");
    let record = put(&ours, 1);
    ours.push(&rig.remote(), &Signing::None).unwrap();
    let pull = |name: &str| rig.store(name).pull(&rig.remote(), &Trust::Anybody).unwrap();
    let object = rig.file(".h5");
    let sound = std::fs::read(&object).unwrap();
    change(&object, |bytes| bytes[100] ^= 1);
    assert!(pull("a").refused[0].contains("its bytes are not those that were written; it is computed again"));
    change(&object, |bytes| bytes.push(0));
    assert!(pull("b").refused[0].contains("it is no plain file of the recorded size"));
    // A torn push: the object is not there, or the segment is cut.
    std::fs::remove_file(&object).unwrap();
    assert!(pull("c").refused[0].contains("its object is not there"));
    std::fs::write(&object, &sound).unwrap();
    let segment = rig.file(".segment");
    let whole = std::fs::read(&segment).unwrap();
    change(&segment, |bytes| bytes.truncate(600));
    assert!(pull("d").refused[0].contains("is not what its name says"));
    // A record that gives another task the object, in a segment with a right name.
    std::fs::remove_file(&segment).unwrap();
    let mut forged = segment::read(blake3::hash(&whole).to_hex().as_ref(), &whole).unwrap();
    forged[0].key = Key::of("another task");
    let bytes = segment::write(forged);
    std::fs::write(segment.with_file_name(format!("{}.segment", blake3::hash(&bytes).to_hex())), &bytes).unwrap();
    let other = ObjectId { key: Key::of("another task"), content: record.content };
    std::fs::write(object.with_file_name(other.file_name()), &sound).unwrap();
    assert!(pull("e").refused[0].contains("it belongs to another task"));
}

#[test]
fn of_two_results_of_one_task_the_own_one_stays_and_it_is_told() {
    let rig = Rig::new();
    let (ours, theirs) = (rig.store("ours"), rig.store("theirs"));
    put(&ours, 1);
    ours.push(&rig.remote(), &Signing::None).unwrap();
    let timing = Timing { started: UNIX_EPOCH, seconds: 0.0 };
    let other = Artifact::new("test", 1, Group::new().with("n", Node::Int(7)));
    let own = theirs.put("flow task 1\nwork test 1\n", other, &timing).unwrap().0;
    let pulled = theirs.pull(&rig.remote(), &Trust::Anybody).unwrap();
    assert!(pulled.refused[0].contains("is not the one here"), "{pulled:?}");
    assert_eq!(theirs.find(&own.key).unwrap().unwrap().content, own.content);
}

#[test]
fn a_folder_that_is_no_remote_is_not_touched() {
    let rig = Rig::new();
    let ours = rig.store("ours");
    put(&ours, 1);
    let full = rig.0.path().join("full");
    std::fs::create_dir(&full).unwrap();
    std::fs::write(full.join("mine.txt"), "x").unwrap();
    for (path, why) in [(full, "it has no file `flow.remote`"), (rig.0.path().join("ours"), "it is a store")] {
        let error = ours.push(&Address::Folder(path), &Signing::None).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
    let error = ours.pull(&Address::Folder(rig.0.path().join("none")), &Trust::Anybody).unwrap_err().to_string();
    assert!(error.contains("there is no such folder"), "{error}");
}

/// The number in the artifact of a record, as a store reads it.
fn number(store: &Store, record: &Record) -> Option<i64> {
    let artifact = store.get(&record.content).ok()?;
    match artifact.root.get("n") {
        Some(Node::Int(number)) => Some(*number),
        _ => None,
    }
}

#[test]
fn an_attached_remote_is_read_when_a_result_is_needed_and_not_before() {
    let rig = Rig::new();
    let (ours, theirs) = (rig.store("ours"), rig.store("theirs"));
    let (signing, trust) = rig.key("ann");
    let records: Vec<Record> = (0..3).map(|number| put(&ours, number)).collect();
    ours.push(&rig.remote(), &signing).unwrap();
    let attachment = theirs.attach(&rig.remote(), &trust).unwrap();
    assert_eq!((attachment.results, attachment.refused.len()), (3, 0));
    assert_eq!(attachment.signers, [("ann@lab".to_owned(), 3)].into());
    assert!(theirs.has_all(&records.iter().map(Record::object).collect::<Vec<_>>()).unwrap());
    assert_eq!(theirs.find(&records[1].key).unwrap().unwrap().content, records[1].content);
    assert!(!theirs.path(&records[1].object()).exists(), "knowing of a result fetches nothing");
    assert_eq!(number(&theirs, &records[1]), Some(1));
    assert!(theirs.path(&records[1].object()).exists() && !theirs.path(&records[0].object()).exists());
    let address = rig.remote().to_string();
    assert_eq!(theirs.take_fetched(), Some((1, address)));
    // What workers of a cluster are to read is fetched before.
    assert!(theirs.locate(&records[2].content).is_ok() && theirs.path(&records[2].object()).exists());
    assert!(theirs.verify().unwrap().strangers.is_empty());
    // Another user of the store has attached nothing.
    let other = Store::open_as(&rig.0.path().join("theirs"), Mark::of(&[9; 32])).unwrap();
    assert_eq!(other.find(&records[0].key).unwrap(), None);
    assert!(theirs.detach().unwrap() && !theirs.detach().unwrap());
    assert_eq!(rig.store("theirs").find(&records[0].key).unwrap(), None);
    assert!(rig.store("theirs").find(&records[1].key).unwrap().is_some(), "what was fetched stays");
}

#[test]
fn what_an_attached_remote_damages_or_nobody_trusted_signs_is_computed_again() {
    let rig = Rig::new();
    let (ours, theirs) = (rig.store("ours"), rig.store("theirs"));
    let ((ann, _), (_, only_bob)) = (rig.key("ann"), rig.key("bob"));
    let record = put(&ours, 1);
    ours.push(&rig.remote(), &ann).unwrap();
    let attachment = rig.store("wary").attach(&rig.remote(), &only_bob).unwrap();
    assert_eq!(attachment.results, 0);
    assert!(attachment.refused[0].contains("its signer is not in"), "{attachment:?}");
    assert_eq!(rig.store("wary").find(&record.key).unwrap(), None);
    theirs.attach(&rig.remote(), &Trust::Anybody).unwrap();
    change(&rig.file(".h5"), |bytes| bytes[100] ^= 1);
    assert!(theirs.find(&record.key).unwrap().is_some());
    assert!(theirs.get(&record.content).unwrap_err().is_missing());
    assert_eq!(theirs.find(&record.key).unwrap(), None, "so its task is computed again");
    let damages = theirs.take_damages();
    let text = damages[0].to_string();
    assert!(text.contains("its bytes are not those that were written") && text.contains("it was not taken"), "{text}");
    // Two that are trusted and contradict each other are both not believed.
    let (third, reader) = (rig.store("third"), rig.store("reader"));
    let timing = Timing { started: UNIX_EPOCH, seconds: 0.0 };
    let other = Artifact::new("test", 1, Group::new().with("n", Node::Int(7)));
    third.put("flow task 1\nwork test 1\n", other, &timing).unwrap();
    third.push(&rig.remote(), &Signing::None).unwrap();
    assert_eq!(reader.attach(&rig.remote(), &Trust::Anybody).unwrap().results, 2);
    assert_eq!(reader.find(&record.key).unwrap(), None);
}
