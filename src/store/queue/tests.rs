use super::*;
use crate::store::Mark;

fn store(folder: &std::path::Path) -> Store {
    Store::open_as(&folder.join("store"), Mark::of(&[1; 32])).unwrap()
}

#[test]
fn a_task_is_begun_once() {
    let folder = tempfile::tempdir().unwrap();
    let queue = store(folder.path()).make_queue("q-1").unwrap();
    assert!(queue.begin(3).unwrap());
    assert!(!queue.begin(3).unwrap());
    assert_eq!(queue.begun().unwrap(), [3]);
}

#[test]
fn a_list_of_anybody_else_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path());
    let queue = store.make_queue("q-1").unwrap();
    assert_eq!(queue.list(1).unwrap(), None);
    queue.put_list(1, "a\nb\n").unwrap();
    assert_eq!(queue.list(1).unwrap().as_deref(), Some("a\nb\n"));
    assert!(queue.put_list(1, "c\n").is_err(), "a list is written once");
    let other = store.queue("q-1", Some([7; 32])).list(1).unwrap_err().to_string();
    assert!(other.contains("not the list that was submitted"), "{other}");
    // The list of one number does not stand in for that of another.
    std::fs::copy(queue.path().join("tasks-0001.jsonl"), queue.path().join("tasks-0002.jsonl")).unwrap();
    assert!(queue.list(2).is_err());
}

#[test]
fn reports_are_read_line_by_line_and_tell_whether_their_worker_lives() {
    let folder = tempfile::tempdir().unwrap();
    let queue = store(folder.path()).make_queue("q-1").unwrap();
    let mut report = queue.report("a").unwrap();
    report.say("one").unwrap();
    let names = queue.reports().unwrap();
    assert_eq!(queue.news(&names[0], 0).unwrap(), ("one\n".to_owned(), 4, true));
    assert_eq!(queue.news(&names[0], 4).unwrap(), (String::new(), 0, true));
    folder::write(&report.file.0, b"torn").unwrap();
    drop(report);
    assert_eq!(queue.news(&names[0], 4).unwrap(), (String::new(), 0, false));
}

#[test]
fn what_lies_in_a_queue_is_known_and_goes_with_gc() {
    let folder = tempfile::tempdir().unwrap();
    let store = store(folder.path());
    let queue = store.make_queue("q-1").unwrap();
    queue.put_list(1, "a\n").unwrap();
    queue.begin(0).unwrap();
    queue.put_script(1, "x").unwrap();
    queue.close().unwrap();
    drop(queue.report("w").unwrap());
    assert!(store.verify().unwrap().strangers.is_empty());
    std::fs::write(queue.path().join("mine.txt"), "x").unwrap();
    assert_eq!(store.verify().unwrap().strangers.len(), 1);
    store.sweep(&Default::default(), true).unwrap();
    assert!(queue.path().join("mine.txt").is_file());
    std::fs::remove_file(queue.path().join("mine.txt")).unwrap();
    store.sweep(&Default::default(), true).unwrap();
    assert!(!queue.path().exists() && queue.is_closed());
}
