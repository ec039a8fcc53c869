use super::hostile::result;
use super::*;
use crate::artifact::Artifact;

fn timing(seconds: f64) -> Timing {
    Timing { started: SystemTime::now(), seconds }
}

#[test]
fn what_was_put_is_found_by_the_next_process() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("store");
    let store = Store::open(&root).unwrap();
    let (record, stored) = store.put("kind = a", result(1.0), &timing(0.0)).unwrap();
    assert_eq!(store.find(&Key::of("kind = a")).unwrap(), Some(record.clone()));

    let next = Store::open(&root).unwrap();
    assert_eq!(next.find(&Key::of("kind = a")).unwrap(), Some(record.clone()));
    assert_eq!(next.find(&Key::of("kind = b")).unwrap(), None);
    assert_eq!(next.get(&record.content).unwrap(), stored);
    assert_eq!(next.task_text(&record).unwrap(), "kind = a");
    assert_eq!(record.content, result(1.0).content_hash());
    assert_eq!(std::fs::read_to_string(root.join(".gitignore")).unwrap(), "*\n");
}

#[test]
fn an_artifact_comes_back_with_the_bits_it_was_handed_out_with() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path()).unwrap();
    let (record, handed) = store.put("t", result(-0.0), &timing(0.2)).unwrap();
    let read = Store::open(folder.path()).unwrap().get(&record.content).unwrap();
    let bits = |artifact: &Artifact| -> Vec<u64> {
        artifact.table("table").unwrap().shown("strength").unwrap().0.iter().map(|v| v.to_bits()).collect()
    };
    assert_eq!(bits(&handed), bits(&read));
    assert_eq!(bits(&read)[0], 0, "a zero with a sign would let equal inputs give different results");
}

#[test]
fn one_of_two_claims_waits() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (Store::open(folder.path()).unwrap(), Store::open(folder.path()).unwrap());
    let key = Key::of("t");
    let Claim::Mine(guard) = first.claim(&key).unwrap() else { panic!("nobody else has it") };
    let Claim::Theirs(waiting) = second.claim(&key).unwrap() else { panic!("the first has it") };
    assert_eq!(waiting.holder.process, std::process::id());
    assert!(!waiting.is_over());
    assert!(!waiting.wait(|| true));
    let (record, _) = first.finish(guard, "t", result(2.0), &timing(0.0)).unwrap();
    assert!(waiting.wait(|| false));
    let Claim::Done(found) = second.claim(&key).unwrap() else { panic!("it is finished") };
    assert_eq!(found, record);
    assert_eq!(std::fs::read_dir(folder.path().join("locks")).unwrap().count(), 0);
}

/// The name of a queue comes from a command line.
#[test]
fn no_name_leads_out_of_a_store() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(folder.path().join("store/queue")).unwrap();
    std::fs::create_dir(folder.path().join("outside")).unwrap();
    let disk = Disk { root: folder.path().join("store"), read_only: false };
    assert!(disk.folder("queue").is_ok());
    let error = disk.find_folder("queue/../../outside").map(|_| ()).unwrap_err();
    assert!(error.to_string().ends_with("a name with `..` leads out of the store"), "{error}");
    assert!(disk.make_folder("queue/../../made").is_err() && !folder.path().join("made").exists());
}

mod faults;
mod fuzz;
