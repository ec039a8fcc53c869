//! What a submitter makes of the reports of its workers.

use super::*;
use crate::store::{MOST_NEWS, Mark};

fn post(folder: &std::path::Path, tasks: u8) -> Post {
    let store = Store::open_as(&folder.join("store"), Mark::of(&[1; 32])).unwrap();
    let mut post = Post::open(&store, "q-1", Site::default().needs("")).unwrap();
    let mut list = Draft::default();
    (0..tasks).for_each(|task| list.add(&format!("line {task}")));
    post.list((0..tasks).map(|task| Key([task; 32])), &list).unwrap();
    post
}

fn started() -> Message {
    Message::Started { round: 1, index: 0, machine: "n1".to_owned(), program: "ab".to_owned() }
}

#[test]
fn a_task_of_which_a_worker_never_said_the_end_is_decided_about_again() {
    let folder = tempfile::tempdir().unwrap();
    let mut post = post(folder.path(), 3);
    let mut report = post.queue.report("1").unwrap();
    let done = Message::Done { task: 0, seconds: 1.0 };
    let begun = (0..3).map(|task| Message::Begun { task });
    for message in [started()].into_iter().chain(begun).chain([done.clone(), Message::Ended { fault: None }]) {
        report.say(&message.to_text()).unwrap();
    }
    post.over(2);
    let Reports { news, .. } = post.read().unwrap();
    let ends: Vec<_> =
        news.into_iter().filter(|(_, news)| !matches!(news, News::Message(Message::Begun { .. }))).collect();
    assert_eq!(ends, [(0, News::Message(done)), (1, News::Message(Message::Elsewhere { task: 1 }))]);
}

#[test]
fn a_line_that_no_worker_writes_does_not_hide_what_follows_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut post = post(folder.path(), 1);
    let mut report = post.queue.report("1").unwrap();
    report.say(&started().to_text()).unwrap();
    report.say(&"x".repeat(2 * MOST_NEWS as usize + 7)).unwrap();
    report.say(&Message::Begun { task: 0 }.to_text()).unwrap();
    let heard: Vec<_> = (0..5).flat_map(|_| post.read().unwrap().news).collect();
    assert_eq!(heard, [(0, News::Message(Message::Begun { task: 0 }))]);
}
