// Where the parameters may lie: a box with linear walls in it, seen as the unit box by scales that are linear or
// logarithmic. Parameters that are held at a value are no directions of it.
const Box = (() => {
  const natural = ({ low, high, log }, u) => {
    if (u >= 1) return high;
    if (log) return u <= 0 ? low : low * Math.exp(u * Math.log(high / low));
    return low + u * (high - low);
  };
  const unit = ({ low, high, log }, x) => log ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low);
  const slope = ({ low, high, log }, x) => log ? x * Math.log(high / low) : high - low;

  // `point` gives the values of what is held; `free` are the parameters that may move.
  const domain = (model, point, held) => {
    const all = model.parameters;
    const free = all.map((_, i) => i).filter((i) => !held[i]);
    const size = free.length;
    const at = (u) => { const x = point.slice(); free.forEach((i, k) => { x[i] = natural(all[i], u[k]); }); return x; };
    const place = (x) => free.map((i) => unit(all[i], x[i]));
    const slopes = (x) => free.map((i) => slope(all[i], x[i]));
    // A wall is Σ a u ≤ b over all parameters; what is held goes to its bound.
    const walls = model.walls.map((wall) => {
      const normal = free.map((i) => wall.normal[i]);
      const fixed = all.reduce((sum, p, i) => held[i] ? sum + wall.normal[i] * unit(p, point[i]) : sum, 0);
      const length = Numeric.norm(normal);
      return { normal: normal.map((a) => a / (length || 1)), bound: (wall.bound - fixed) / (length || 1), length, text: wall.text };
    });
    const broken = walls.filter((wall) => wall.length === 0 && wall.bound < -1e-9);
    const kept = walls.filter((wall) => wall.length > 0);
    const holds = (u) => u.every((x) => x >= -1e-9 && x <= 1 + 1e-9) && kept.every((wall) => Numeric.dot(wall.normal, u) <= wall.bound + 1e-9);
    // All bounds as rows · step ≥ bounds from a place.
    const bounds = (u) => {
      const rows = [], limits = [];
      for (const wall of kept) { rows.push(wall.normal.map((a) => -a)); limits.push(Numeric.dot(wall.normal, u) - wall.bound); }
      for (let i = 0; i < size; i++) {
        const along = new Array(size).fill(0);
        along[i] = 1;
        rows.push(along, along.map((a) => -a));
        limits.push(-u[i], u[i] - 1);
      }
      return [rows, limits];
    };
    const clip = (u) => u.map((x) => Math.min(Math.max(x, 0), 1));
    const repair = (u) => {
      const clipped = clip(u);
      if (holds(clipped)) return clipped;
      const step = Numeric.leastDistance(...bounds(clipped), size);
      return step ? clip(clipped.map((x, i) => x + step[i])) : clipped;
    };
    const centre = () => repair(free.map((i) => model.parameters[i].preferred === null ? 0.5 : unit(all[i], all[i].preferred)));
    return { free, size, at, place, slopes, holds, bounds, clip, repair, centre, broken, isBox: kept.length === 0 };
  };

  return { domain, natural, unit };
})();
