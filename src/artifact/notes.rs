//! The table of notes that every analysis has.

crate::table! {
    /// what to look at before trusting the numbers
    pub struct NoteTable {
        /// the response it is about
        pub response: Vec<String>, "";
        /// the remark
        pub note: Vec<String>, "";
    }
}
