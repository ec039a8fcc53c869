//! The memory of a stage between two of its steps in one campaign.
//!
//! [`crate::stage::Stage::next`] is called again after every batch of outcomes, and the next step is a function of the whole
//! history. A memory makes it unnecessary to replay that history each time. It may be lost at any moment, and a stage must
//! take the same step with and without it: it holds only values that can be computed again.

use std::any::Any;
use std::cell::RefCell;
use std::fmt;

/// A value of the stage's own type, or nothing.
#[derive(Default)]
pub struct Memory(RefCell<Option<Box<dyn Any>>>);

impl Memory {
    /// Removes and returns the value, if it is of this type.
    pub fn take<T: 'static>(&self) -> Option<T> {
        self.0.borrow_mut().take()?.downcast().ok().map(|value| *value)
    }

    /// Stores a value, which replaces any other.
    pub fn put<T: 'static>(&self, value: T) {
        *self.0.borrow_mut() = Some(Box::new(value));
    }
}

impl fmt::Debug for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.borrow().is_some() { "Memory(something)" } else { "Memory(nothing)" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_comes_out_once_and_only_as_what_it_is() {
        let memory = Memory::default();
        assert_eq!(memory.take::<u8>(), None);
        memory.put(7_u8);
        assert_eq!((memory.take::<u8>(), memory.take::<u8>()), (Some(7), None));
        memory.put(7_u8);
        assert_eq!((memory.take::<u16>(), memory.take::<u8>()), (None, None));
    }
}
