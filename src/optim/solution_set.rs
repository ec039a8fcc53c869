//! All the parameters that meet the targets, when there is more than one answer.
