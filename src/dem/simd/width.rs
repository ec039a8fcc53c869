//! Which lane type this machine runs.

use super::Lane;
#[cfg(target_arch = "x86_64")]
use super::{eight::Eight, four::Four};

/// Contacts computed at a time. The choice changes the time, never a bit of the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// Plain numbers: any machine.
    One,
    /// AVX2.
    Four,
    /// AVX-512.
    Eight,
}

impl Width {
    /// The widest one that this machine has.
    pub fn detect() -> Self {
        [Self::Eight, Self::Four].into_iter().find(|w| w.available()).unwrap_or(Self::One)
    }

    /// Whether this machine has it.
    pub fn available(self) -> bool {
        match self {
            Self::One => true,
            #[cfg(target_arch = "x86_64")]
            Self::Four => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Eight => is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq"),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Four | Self::Eight => false,
        }
    }
}

/// Work that is written over a lane type. `run` must be `#[inline(always)]`, or it is compiled without the wide
/// instructions.
pub(crate) trait Kernel {
    /// What it returns.
    type Output;
    /// The work.
    fn run<L: Lane>(self) -> Self::Output;
}

/// Runs a kernel at a width; at the narrowest one where the machine lacks it.
pub(crate) fn dispatch<K: Kernel>(width: Width, kernel: K) -> K::Output {
    match width {
        // SAFETY: the features were just found on this processor.
        #[cfg(target_arch = "x86_64")]
        Width::Four if width.available() => unsafe { run_four(kernel) },
        // SAFETY: the same.
        #[cfg(target_arch = "x86_64")]
        Width::Eight if width.available() => unsafe { run_eight(kernel) },
        _ => kernel.run::<f64>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_four<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Four>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq")]
fn run_eight<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Eight>()
}
