//! Four contacts in an AVX2 register.
//!
//! Every call is sound because [`super::width::dispatch`] is the only way here, and it has asked the processor.

use super::{Lane, Quad, Row};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Four contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Four(__m256d);

macro_rules! operator {
    ($trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for Four {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the head.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}
operator!(Add, add, _mm256_add_pd);
operator!(Sub, sub, _mm256_sub_pd);
operator!(Mul, mul, _mm256_mul_pd);
operator!(Div, div, _mm256_div_pd);

impl Neg for Four {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

/// Rows to columns and back.
#[inline(always)]
fn transpose([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    // SAFETY: see the head.
    unsafe {
        let (ab, cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
        let (ab_high, cd_high) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab, cd),
            _mm256_permute2f128_pd::<0x20>(ab_high, cd_high),
            _mm256_permute2f128_pd::<0x31>(ab, cd),
            _mm256_permute2f128_pd::<0x31>(ab_high, cd_high),
        ]
    }
}

/// One row of a table.
#[inline(always)]
fn read(quad: &Quad) -> __m256d {
    // SAFETY: a quad is 32 bytes, aligned to 32.
    unsafe { _mm256_load_pd(quad.0.as_ptr()) }
}

/// Adds the rows of contact `k` to one record of a table.
#[inline(always)]
fn add_to<const ROWS: usize>(record: &mut [Quad; ROWS], value: &[[__m256d; 4]; ROWS], k: usize) {
    for (row, add) in record.iter_mut().zip(value) {
        // SAFETY: a quad is 32 bytes, aligned to 32.
        unsafe { _mm256_store_pd(row.0.as_mut_ptr(), _mm256_add_pd(_mm256_load_pd(row.0.as_ptr()), add[k])) }
    }
}

impl Lane for Four {
    type Mask = __m256d;
    const WIDTH: usize = 4;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm256_set1_pd(x) })
    }
    #[inline(always)]
    fn load(row: &Row, at: usize) -> Self {
        let part: &[f64; 4] = if at == 0 { row.0.first_chunk() } else { row.0.last_chunk() }.unwrap_or(&[0.0; 4]);
        // SAFETY: four numbers.
        Self(unsafe { _mm256_loadu_pd(part.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, row: &mut Row, at: usize) {
        let part = if at == 0 { row.0.first_chunk_mut() } else { row.0.last_chunk_mut() };
        let part: Option<&mut [f64; 4]> = part;
        if let Some(part) = part {
            // SAFETY: four numbers.
            unsafe { _mm256_storeu_pd(part.as_mut_ptr(), self.0) }
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm256_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> __m256d {
        // SAFETY: see the head.
        unsafe { _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn or(a: __m256d, b: __m256d) -> __m256d {
        // SAFETY: see the head.
        unsafe { _mm256_or_pd(a, b) }
    }
    #[inline(always)]
    fn select(mask: __m256d, yes: Self, no: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
    }
    #[inline(always)]
    fn bits(mask: __m256d) -> u8 {
        // SAFETY: see the head.
        unsafe { _mm256_movemask_pd(mask) as u8 }
    }
    #[inline(always)]
    fn gather<const ROWS: usize>(table: &[Quad], ends: &[u32]) -> [[Self; 4]; ROWS] {
        let records = table.as_chunks::<ROWS>().0;
        let at = |k: usize| &records[ends[k] as usize];
        let [a, b, c, d] = [at(0), at(1), at(2), at(3)];
        let mut turned = [[Self::splat(0.0); 4]; ROWS];
        for (row, turned) in turned.iter_mut().enumerate() {
            let [x, y, z, w] = transpose([read(&a[row]), read(&b[row]), read(&c[row]), read(&d[row])]);
            *turned = [Self(x), Self(y), Self(z), Self(w)];
        }
        turned
    }
    #[inline(always)]
    fn scatter_add<const ROWS: usize>(table: &mut [Quad], ends: &[u32], value: [[Self; 4]; ROWS]) {
        let records = table.as_chunks_mut::<ROWS>().0;
        let value = turned(value);
        for k in 0..4 {
            add_to(&mut records[ends[k] as usize], &value, k);
        }
    }
    #[inline(always)]
    fn scatter_add_both<const ROWS: usize>(table: &mut [Quad], ends: [&[u32]; 2], value: [[[Self; 4]; ROWS]; 2]) {
        let records = table.as_chunks_mut::<ROWS>().0;
        let [first, second] = [turned(value[0]), turned(value[1])];
        for k in 0..4 {
            add_to(&mut records[ends[0][k] as usize], &first, k);
            add_to(&mut records[ends[1][k] as usize], &second, k);
        }
    }
}

/// Four columns as four rows.
#[inline(always)]
fn rows([x, y, z, w]: [Four; 4]) -> [__m256d; 4] {
    transpose([x.0, y.0, z.0, w.0])
}

/// The rows of some records, each from its four columns.
#[inline(always)]
fn turned<const ROWS: usize>(value: [[Four; 4]; ROWS]) -> [[__m256d; 4]; ROWS] {
    let mut turned = [rows(value[0]); ROWS];
    for row in 1..ROWS {
        turned[row] = rows(value[row]);
    }
    turned
}
