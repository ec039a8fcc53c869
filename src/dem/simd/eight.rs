//! Eight contacts in an AVX-512 register.
//!
//! Every call is sound because [`super::width::dispatch`] is the only way here, and it has asked the processor.

use super::{Lane, Quad, Row};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Eight contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight(__m512d);

macro_rules! operator {
    ($trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for Eight {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the head.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}
operator!(Add, add, _mm512_add_pd);
operator!(Sub, sub, _mm512_sub_pd);
operator!(Mul, mul, _mm512_mul_pd);
operator!(Div, div, _mm512_div_pd);

impl Neg for Eight {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

/// Two rows of a table side by side.
#[inline(always)]
fn pair(low: &Quad, high: &Quad) -> __m512d {
    // SAFETY: a quad is 32 bytes, aligned to 32.
    unsafe {
        let low = _mm512_castpd256_pd512(_mm256_load_pd(low.0.as_ptr()));
        _mm512_insertf64x4::<1>(low, _mm256_load_pd(high.0.as_ptr()))
    }
}

/// Eight rows as four columns. `x02` and the like: what is in each sixteen bytes.
#[inline(always)]
fn columns(rows: [&Quad; 8]) -> [Eight; 4] {
    let [a, b] = [pair(rows[0], rows[2]), pair(rows[1], rows[3])];
    let [c, d] = [pair(rows[4], rows[6]), pair(rows[5], rows[7])];
    // SAFETY: see the head.
    unsafe {
        // x01 z01 x23 z23, x45 z45 x67 z67, and y, w.
        let (xz_low, xz_high) = (_mm512_unpacklo_pd(a, b), _mm512_unpacklo_pd(c, d));
        let (yw_low, yw_high) = (_mm512_unpackhi_pd(a, b), _mm512_unpackhi_pd(c, d));
        [
            Eight(_mm512_shuffle_f64x2::<0x88>(xz_low, xz_high)),
            Eight(_mm512_shuffle_f64x2::<0x88>(yw_low, yw_high)),
            Eight(_mm512_shuffle_f64x2::<0xDD>(xz_low, xz_high)),
            Eight(_mm512_shuffle_f64x2::<0xDD>(yw_low, yw_high)),
        ]
    }
}

/// Four columns as eight rows.
#[inline(always)]
fn rows([x, y, z, w]: [Eight; 4]) -> [__m256d; 8] {
    // SAFETY: see the head.
    unsafe {
        // x0y0 x2y2 x4y4 x6y6, the odd ones, and z, w.
        let (xy_even, xy_odd) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
        let (zw_even, zw_odd) = (_mm512_unpacklo_pd(z.0, w.0), _mm512_unpackhi_pd(z.0, w.0));
        let near = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
        let far = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
        let a = halves(_mm512_permutex2var_pd(xy_even, near, zw_even));
        let b = halves(_mm512_permutex2var_pd(xy_odd, near, zw_odd));
        let c = halves(_mm512_permutex2var_pd(xy_even, far, zw_even));
        let d = halves(_mm512_permutex2var_pd(xy_odd, far, zw_odd));
        [a[0], b[0], a[1], b[1], c[0], d[0], c[1], d[1]]
    }
}

/// The rows of some records, each from its four columns.
#[inline(always)]
fn turned<const ROWS: usize>(value: [[Eight; 4]; ROWS]) -> [[__m256d; 8]; ROWS] {
    let mut turned = [rows(value[0]); ROWS];
    for row in 1..ROWS {
        turned[row] = rows(value[row]);
    }
    turned
}

/// The first and the last four.
#[inline(always)]
fn halves(x: __m512d) -> [__m256d; 2] {
    // SAFETY: see the head.
    unsafe { [_mm512_castpd512_pd256(x), _mm512_extractf64x4_pd::<1>(x)] }
}

/// Adds the rows of contact `k` to one record of a table.
#[inline(always)]
fn add_to<const ROWS: usize>(record: &mut [Quad; ROWS], value: &[[__m256d; 8]; ROWS], k: usize) {
    for (row, add) in record.iter_mut().zip(value) {
        // SAFETY: a quad is 32 bytes, aligned to 32.
        unsafe { _mm256_store_pd(row.0.as_mut_ptr(), _mm256_add_pd(_mm256_load_pd(row.0.as_ptr()), add[k])) }
    }
}

impl Lane for Eight {
    type Mask = u8;
    const WIDTH: usize = 8;
    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_set1_pd(x) })
    }
    #[inline(always)]
    fn load(row: &Row, _at: usize) -> Self {
        // SAFETY: a row is 64 bytes, aligned to 64.
        Self(unsafe { _mm512_load_pd(row.0.as_ptr()) })
    }
    #[inline(always)]
    fn store(self, row: &mut Row, _at: usize) {
        // SAFETY: a row is 64 bytes, aligned to 64.
        unsafe { _mm512_store_pd(row.0.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> u8 {
        // SAFETY: see the head.
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn or(a: u8, b: u8) -> u8 {
        a | b
    }
    #[inline(always)]
    fn select(mask: u8, yes: Self, no: Self) -> Self {
        // SAFETY: see the head.
        Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn bits(mask: u8) -> u8 {
        mask
    }
    #[inline(always)]
    fn gather<const ROWS: usize>(table: &[Quad], ends: &[u32]) -> [[Self; 4]; ROWS] {
        let records = table.as_chunks::<ROWS>().0;
        let at = |k: usize| &records[ends[k] as usize];
        let [a, b, c, d, e, f, g, h] = [at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)];
        let mut turned = [[Self::splat(0.0); 4]; ROWS];
        for (row, turned) in turned.iter_mut().enumerate() {
            *turned = columns([&a[row], &b[row], &c[row], &d[row], &e[row], &f[row], &g[row], &h[row]]);
        }
        turned
    }
    #[inline(always)]
    fn scatter_add<const ROWS: usize>(table: &mut [Quad], ends: &[u32], value: [[Self; 4]; ROWS]) {
        let records = table.as_chunks_mut::<ROWS>().0;
        let value = turned(value);
        for k in 0..8 {
            add_to(&mut records[ends[k] as usize], &value, k);
        }
    }
    #[inline(always)]
    fn scatter_add_both<const ROWS: usize>(table: &mut [Quad], ends: [&[u32]; 2], value: [[[Self; 4]; ROWS]; 2]) {
        let records = table.as_chunks_mut::<ROWS>().0;
        let [first, second] = [turned(value[0]), turned(value[1])];
        for k in 0..8 {
            add_to(&mut records[ends[0][k] as usize], &first, k);
            add_to(&mut records[ends[1][k] as usize], &second, k);
        }
    }
}
