// Linear algebra of a few dozen numbers: least squares, non-negative least squares, the point of a polyhedron nearest to
// the origin (Lawson & Hanson, Solving Least Squares Problems, chapter 23), and the rank of a matrix.
const Numeric = (() => {
  const dot = (a, b) => { let sum = 0; for (let i = 0; i < a.length; i++) sum += a[i] * b[i]; return sum; };
  const norm = (a) => Math.sqrt(dot(a, a));

  // Unconstrained least squares over some columns, by Householder's reflections; null when they are dependent.
  const leastSquares = (columns, right) => {
    const rows = right.length, count = columns.length;
    if (count > rows) return null;
    const a = columns.map((column) => column.slice()), b = right.slice();
    for (let k = 0; k < count; k++) {
      const column = a[k];
      let length = 0;
      for (let i = k; i < rows; i++) length += column[i] * column[i];
      length = Math.sqrt(length);
      if (length < 1e-13) return null;
      const alpha = column[k] > 0 ? -length : length;
      const v = new Array(rows).fill(0);
      for (let i = k; i < rows; i++) v[i] = column[i];
      v[k] -= alpha;
      const square = dot(v, v);
      const reflect = (x) => {
        let s = 0;
        for (let i = k; i < rows; i++) s += v[i] * x[i];
        s *= 2 / square;
        for (let i = k; i < rows; i++) x[i] -= s * v[i];
      };
      for (let j = k; j < count; j++) reflect(a[j]);
      reflect(b);
    }
    const z = new Array(count).fill(0);
    for (let k = count - 1; k >= 0; k--) {
      let sum = b[k];
      for (let j = k + 1; j < count; j++) sum -= a[j][k] * z[j];
      z[k] = sum / a[k][k];
    }
    return z;
  };

  const residual = (columns, f, w) => {
    const r = f.slice();
    columns.forEach((column, j) => { if (w[j] !== 0) for (let i = 0; i < r.length; i++) r[i] -= w[j] * column[i]; });
    return r;
  };

  // Least squares over the passive columns, giving up those that would turn negative; false when the newest cannot stay.
  const settle = (columns, f, w, passive) => {
    const newest = passive[passive.length - 1];
    for (;;) {
      const z = leastSquares(passive.map((j) => columns[j]), f);
      if (!z) { passive.pop(); return false; }
      const at = passive.indexOf(newest);
      if (at >= 0 && z[at] <= 0 && w[newest] === 0) { passive.splice(at, 1); return false; }
      let step = Infinity;
      passive.forEach((j, k) => { if (z[k] <= 0) step = Math.min(step, w[j] / (w[j] - z[k])); });
      if (step === Infinity) { passive.forEach((j, k) => { w[j] = z[k]; }); return true; }
      passive.forEach((j, k) => {
        w[j] += step * (z[k] - w[j]);
        if (z[k] <= 0 && w[j] <= 1e-15) w[j] = 0;
      });
      for (let k = passive.length - 1; k >= 0; k--) if (!(w[passive[k]] > 0)) passive.splice(k, 1);
    }
  };

  // The w ≥ 0 with the least ‖E w − f‖, E given by its columns.
  const nonNegative = (columns, f) => {
    const w = new Array(columns.length).fill(0), passive = [];
    for (let turn = 0; turn < 3 * columns.length + 10; turn++) {
      const r = residual(columns, f, w);
      let best = -1, most = 1e-12;
      for (let j = 0; j < columns.length; j++) {
        if (passive.includes(j)) continue;
        const dual = dot(columns[j], r);
        if (dual > most) { most = dual; best = j; }
      }
      if (best < 0) break;
      passive.push(best);
      if (!settle(columns, f, w, passive)) break;
    }
    return w;
  };

  // The least y with rows[i] · y ≥ bounds[i] for all i; null when no y meets them all.
  const leastDistance = (rows, bounds, size) => {
    if (!rows.length) return new Array(size).fill(0);
    const columns = rows.map((row, i) => [...row, bounds[i]]);
    const f = new Array(size + 1).fill(0);
    f[size] = 1;
    const r = residual(columns, f, nonNegative(columns, f)).map((x) => -x);
    if (dot(r, r) < 1e-18) return null;
    return r.slice(0, size).map((x) => -x / r[size]);
  };

  // By elimination with full pivoting, whose pivots fall off as the singular values do.
  const rank = (rows) => {
    const a = rows.map((row) => row.slice());
    let largest = 0, found = 0;
    for (let k = 0; k < Math.min(a.length, a.length ? a[0].length : 0); k++) {
      let p = k, q = k;
      for (let i = k; i < a.length; i++) for (let j = k; j < a[i].length; j++) if (Math.abs(a[i][j]) > Math.abs(a[p][q])) { p = i; q = j; }
      const pivot = Math.abs(a[p][q]);
      largest = Math.max(largest, pivot);
      if (!(pivot > 1e-6 * largest)) break;
      found++;
      [a[k], a[p]] = [a[p], a[k]];
      for (const row of a) [row[k], row[q]] = [row[q], row[k]];
      for (let i = k + 1; i < a.length; i++) {
        const share = a[i][k] / a[k][k];
        for (let j = k; j < a[i].length; j++) a[i][j] -= share * a[k][j];
      }
    }
    return found;
  };

  // The number with this index of a sequence that fills the unit interval evenly (van der Corput), in a prime base.
  const primes = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];
  const even = (index, dimension) => {
    const base = primes[dimension % primes.length];
    let sum = 0, part = 1;
    for (let i = index; i > 0; i = Math.floor(i / base)) { part /= base; sum += part * (i % base); }
    return sum;
  };

  return { dot, norm, leastDistance, rank, even };
})();
