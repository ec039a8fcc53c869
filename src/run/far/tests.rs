//! What the run loop knows of the tasks that workers have.

use super::*;
use crate::stage::Task;
use crate::store::Mark;
use serde_json::json;

/// A site whose scheduler says that job 7 is there.
fn site() -> Site {
    let text = "scheduler = \"commands\"\n[commands]\nsubmit = [\"echo\", \"7\"]\nalive = [\"echo\", \"7\"]\n\
                cancel = [\"true\"]\nindex = \"0\"\n";
    Site::parse(text).unwrap()
}

fn line(number: u64) -> (Key, String) {
    let task = Task::new("formula", json!({})).seed(number);
    let key = Key([number as u8; 32]);
    (key, Line::new(&task, &key, "rows", &[], None).to_text())
}

/// News that a worker has begun the task of this number.
fn begun(task: usize) -> (usize, News) {
    (task, News::Message(Message::Begun { task }))
}

#[test]
fn of_a_task_that_was_listed_twice_the_last_line_counts_for_who_takes_over() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_as(&folder.path().join("store"), Mark::of(&[1; 32])).unwrap();
    let queue = store.make_queue("1-1").unwrap();
    let (one, two) = (line(1), line(2));
    queue.put_list(1, &format!("{}\n{}\n", one.1, two.1)).unwrap();
    // The worker of the first task was stopped.
    queue.put_list(2, &format!("{}\n", one.1)).unwrap();
    queue.put_round(1, "{\"job\":\"7\",\"workers\":1}").unwrap();
    let site = site();
    let (mut far, words, adopted) = Far::new(&store, &site);
    assert_eq!(adopted, Ok(()), "{words:?}");
    assert_eq!((far.posts.len(), far.posts[0].left()), (1, 2), "{words:?}");
    let mut heard = Vec::new();
    far.sort(0, vec![begun(0), begun(2)], &mut heard).unwrap();
    assert!(matches!(heard[..], [Heard::Begun(key)] if key == one.0));
    far.forget(&one.0);
    far.forget(&two.0);
    assert!(far.is_idle() && far.posts[0].left() == 0);
}

#[test]
fn a_task_is_handed_over_from_its_draft_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open_as(&folder.path().join("store"), Mark::of(&[1; 32])).unwrap();
    let site = site();
    let (mut far, ..) = Far::new(&store, &site);
    let (one, two) = (line(1), line(2));
    for (key, text) in [&one, &two] {
        far.collect(site.needs("rows"), *key, Tries::default(), text).unwrap();
    }
    assert!(far.has(&one.0) && !far.is_idle(), "before it is listed");
    // The run decides about the first one again before the list is written.
    far.forget(&one.0);
    far.send().unwrap();
    assert!(!far.has(&one.0) && far.has(&two.0));
    assert_eq!(far.posts[0].left(), 1);
    // Its worker is stopped, so it is listed again.
    let stopped = Message::Stopped { task: 1, cause: Cause::Time };
    let mut heard = Vec::new();
    far.sort(0, vec![(1, News::Message(stopped))], &mut heard).unwrap();
    assert!(far.has(&two.0) && far.posts[0].left() == 0 && heard.is_empty());
    far.send().unwrap();
    assert_eq!(far.posts[0].left(), 1);
    far.forget(&two.0);
    assert!(far.is_idle() && far.posts[0].left() == 0);
}
