// From targets to parameters, on the surfaces: the solution nearest the preferred point, others that are as good, what each
// parameter can be, which target ties it, and what can be had at all.
const Solve = (() => {
  const SAME = 1e-12, ITERATIONS = 60;
  const size = (w) => w === 0 ? 1 : Math.abs(w);
  // Of a band the end that others are measured by.
  const reference = ([low, high]) => Number.isFinite(low) ? low : high;

  // The places whose quantities lie in given bands. `rise(u)` gives their values and slopes in the unit box. Where `any` of
  // them will do, the search ends at the first.
  const level = (domain, rise, bands, same = 1e-9, any = false) => {
    const beyond = (values) => values.map((y, j) => {
      const [low, high] = bands[j], scale = size(reference(bands[j]));
      return [(y - low) / scale, (y - high) / scale];
    });
    const worst = (ends) => ends.reduce((most, [low, high]) => Math.max(most, -low, high), 0);
    const isMet = (u) => { const { values } = rise(u); return values.every(Number.isFinite) && worst(beyond(values)) <= same; };

    // The allowed place nearest `preference` that meets the linearised quantities, or as much of them as is allowed.
    const step = (u, ends, slopes, preference) => {
      for (let part = 1, turn = 0; turn < 12; turn++, part /= 2) {
        const [rows, limits] = domain.bounds(preference);
        slopes.forEach((slope, j) => {
          const scale = size(reference(bands[j])), row = slope.map((s) => s / scale), length = Numeric.norm(row);
          if (length === 0) return;
          let offset = 0;
          for (let i = 0; i < row.length; i++) offset += row[i] * (u[i] - preference[i]);
          const [low, high] = ends[j], exact = bands[j][0] === bands[j][1];
          // Only what is passed is approached in parts: the other end of a band must hold at once.
          const share = (passed, is) => (offset - (is || exact ? part * passed : passed)) / length;
          if (Number.isFinite(low)) { rows.push(row.map((r) => r / length)); limits.push(share(low, low < 0)); }
          if (Number.isFinite(high)) { rows.push(row.map((r) => -r / length)); limits.push(-share(high, high > 0)); }
        });
        const y = Numeric.leastDistance(rows, limits, domain.size);
        if (y) return domain.clip(preference.map((p, i) => p + y[i]));
      }
      return null;
    };

    const nearest = (start, preference) => {
      let u = start.slice(), last = null, before = Infinity;
      for (let turn = 0; turn < ITERATIONS; turn++) {
        const { values, slopes } = rise(u);
        const ends = beyond(values);
        if (any) {
          const is = worst(ends);
          if (is <= same) return u;
          // A solution that exists is reached in a few steps.
          if (turn % 5 === 4) { if (is > 0.5 * before) return null; before = is; }
        }
        const aim = step(u, ends, slopes, preference);
        if (!aim) return null;
        const limit = Math.max(2 * worst(ends), 0.02);
        let next = aim;
        for (let part = 0.5; part > 1e-3 && worst(beyond(rise(next).values)) > limit; part /= 2) {
          const share = part;
          next = u.map((x, i) => x + share * (aim[i] - x));
        }
        // Along a bent surface whole steps go to and fro across the nearest place: half of one that turns back lands beside it.
        const back = last && Numeric.dot(last, next.map((x, i) => x - u[i])) < 0;
        if (back) next = next.map((x, i) => 0.5 * (x + u[i]));
        next = domain.repair(next);
        last = next.map((x, i) => x - u[i]);
        const moved = next.reduce((most, x, i) => Math.max(most, Math.abs(x - u[i])), 0);
        u = next;
        if (moved < 1e-9 && worst(beyond(rise(u).values)) <= SAME) break;
        if (moved < Math.max(1e-12, 1e-3 * same)) break;
      }
      return u;
    };
    // Slopes of the quantities that stand at an end of their band.
    const active = (u) => {
      const { values, slopes } = rise(u), ends = beyond(values);
      return slopes.filter((_, j) => ends[j][0] <= 1e-6 || ends[j][1] >= -1e-6).map((row, j) => row.map((s) => s / size(reference(bands[j]))));
    };
    return { isMet, nearest, active };
  };

  // The wanted responses at a place, with slopes.
  const responses = (model, domain, aims) => (u) => {
    const x = domain.at(u), along = domain.slopes(x), values = [], slopes = [];
    for (const { response } of aims) {
      const { value, slope } = Surface.rise(model.responses[response], x, x.length);
      values.push(value);
      slopes.push(domain.free.map((i, k) => slope[i] * along[k]));
    }
    return { values, slopes };
  };

  // Signed relative deviations as the calibration's misfit takes them, and the misfit.
  const wantedOf = ({ low, high }, y) => y < low ? low : y > high ? high : low === high ? low : y;
  const scales = (model, aims) => {
    const ends = aims.flatMap(({ low, high }) => [low, high]).filter(Number.isFinite);
    const largest = Math.max(...ends.map(Math.abs), 0);
    return (wanted, y) => model.denominator === "computed" ? Math.abs(y) : model.denominator === "largest" ? largest : Math.abs(wanted);
  };
  const deviations = (model, aims, values) => {
    const scale = scales(model, aims);
    return aims.map((aim, k) => { const wanted = wantedOf(aim, values[k]); return values[k] === wanted ? 0 : (values[k] - wanted) / scale(wanted, values[k]); });
  };
  const weightOf = (model, aim) => model.responses[aim.response].weight;
  const misfit = (model, aims, values) => {
    const parts = deviations(model, aims, values).map((d, k) => [weightOf(model, aims[k]), Math.abs(d)]);
    if (parts.some(([, d]) => Number.isNaN(d))) return Infinity;
    if (model.form === "maximum") return parts.reduce((most, [w, d]) => Math.max(most, w * d), 0);
    return parts.reduce((sum, [w, d]) => sum + w * d * (model.form === "squares" ? d : 1), 0);
  };

  // Descends the misfit: its deviations are linear for a step, what they leave is carried by slacks of their own, and the
  // step is held short while it does not pay. One least-distance problem a step.
  const SLACK = 1e-4;
  const improve = (model, domain, aims, start) => {
    const rise = responses(model, domain, aims);
    const scale = scales(model, aims);
    const of = (u) => misfit(model, aims, rise(u).values);
    const slacks = model.form === "maximum" ? 1 : aims.length, n = domain.size;
    const curve = (k) => model.form === "squares" ? 2 * weightOf(model, aims[k]) : SLACK;
    const pull = (k) => model.form === "squares" ? 0 : model.form === "maximum" ? 1 : weightOf(model, aims[k]);
    let u = start.slice(), best = of(u), hold = 1e-3;
    for (let turn = 0; turn < 80 && best > 1e-13 && hold < 1e9; turn++) {
      const { values, slopes } = rise(u);
      // Unknowns: √hold · step, then √curve · (slack + pull/curve).
      const [bounds, limits] = domain.bounds(u);
      const rows = bounds.map((row) => [...row.map((a) => a / Math.sqrt(hold)), ...new Array(slacks).fill(0)]);
      const add = (row, slack, limit, k) => {
        const root = Math.sqrt(curve(slack)), weight = model.form === "maximum" ? weightOf(model, aims[k]) : 1;
        const full = [...row.map((a) => weight * a / Math.sqrt(hold)), ...new Array(slacks).fill(0)];
        full[n + slack] = 1 / root;
        const length = Numeric.norm(full);
        rows.push(full.map((a) => a / length));
        limits.push((weight * limit + pull(slack) / curve(slack)) / length);
      };
      for (let i = 0; i < rows.length; i++) { const length = Numeric.norm(rows[i]); rows[i] = rows[i].map((a) => a / length); limits[i] /= length; }
      aims.forEach((aim, k) => {
        const slack = model.form === "maximum" ? 0 : k, y = values[k];
        const along = (wanted, sign) => { const s = scale(wanted, y) || 1; add(slopes[k].map((a) => -sign * a / s), slack, sign * (y - wanted) / s, k); };
        if (Number.isFinite(aim.low)) along(aim.low, -1);
        if (Number.isFinite(aim.high)) along(aim.high, 1);
      });
      const y = Numeric.leastDistance(rows, limits, n + slacks);
      if (!y) { hold *= 10; continue; }
      const next = domain.repair(u.map((x, i) => x + y[i] / Math.sqrt(hold)));
      const found = of(next);
      if (found < best) {
        const gain = best - found;
        u = next;
        best = found;
        hold = Math.max(hold / 5, 1e-6);
        if (gain < 1e-14) break;
      } else hold *= 8;
    }
    return { u, misfit: best };
  };

  const places = (domain, count) => Array.from({ length: count }, (_, i) => domain.repair(domain.free.map((_, k) => Numeric.even(i + 1, k))));

  // The least misfit over the domain, from the best of many places.
  const minimise = (model, domain, aims, from) => {
    const of = (u) => { const x = domain.at(u); return misfit(model, aims, aims.map(({ response }) => Surface.value(model.responses[response], x))); };
    const ranked = [...from, ...places(domain, 96)].map((u) => ({ u, misfit: of(u) })).sort((a, b) => a.misfit - b.misfit);
    let best = ranked[0];
    for (const { u } of ranked.slice(0, 6)) {
      const found = improve(model, domain, aims, u);
      if (found.misfit < best.misfit) best = found;
      if (best.misfit < 1e-12) break;
    }
    return best;
  };

  // Least and greatest value of a surface over the domain: along one parameter after the other, from the best of many places.
  const reach = (surface, domain) => {
    const extreme = (sign) => {
      const of = (u) => sign * Surface.value(surface, domain.at(u));
      const own = domain.free.map((i, k) => [i, k]).filter(([i]) => surface.axes.some((axis) => axis.parameter === i)).map(([, k]) => k);
      const descend = (start) => {
        let u = start.slice(), best = of(u);
        for (let sweep = 0; sweep < 30; sweep++) {
          const before = best;
          for (const k of own) {
            const tried = (v) => { const next = u.slice(); next[k] = v; return domain.holds(next) ? of(next) : Infinity; };
            const [a, b, c] = [0, 0.5, 1].map(tried), bend = 2 * (a + c - 2 * b);
            const bottom = bend > 0 ? 0.25 * (3 * a - 4 * b + c) / (0.5 * bend) : NaN;
            const candidates = [0, 1, bottom, u[k] - 0.01, u[k] + 0.01].filter((v) => v >= 0 && v <= 1);
            for (const v of candidates) { const found = tried(v); if (found < best) { best = found; u[k] = v; } }
          }
          if (before - best <= 1e-13 * Math.abs(best)) break;
        }
        return best;
      };
      const ranked = places(domain, 64).map((u) => [of(u), u]).sort((x, y) => x[0] - y[0]);
      return sign * Math.min(...ranked.slice(0, 5).map(([, u]) => descend(u)));
    };
    return [extreme(1), extreme(-1)];
  };

  // Whether a parameter can be as low or as high as a value while the interval of every response reaches what it must
  // (profile intervals): the place where it is so, or null.
  const probe = (model, domain, aims, bands) => (k, sign, v, from) => {
    const ends = bands.flatMap(([low, high]) => [[low, Infinity], [-Infinity, high]]);
    const asked = [...ends, [sign > 0 ? 1 + v : 2 - v, Infinity]];
    // An end of a band that is open asks for nothing.
    const keep = asked.map((_, i) => i).filter((i) => asked[i].some(Number.isFinite));
    const rise = (u) => {
      const x = domain.at(u), along = domain.slopes(x), values = [], slopes = [];
      aims.forEach(({ response }) => {
        const { value, reach: half, slope, widening } = Surface.rise(model.responses[response], x, x.length);
        for (const end of [1, -1]) { values.push(value + end * half); slopes.push(domain.free.map((i, j) => (slope[i] + end * widening[i]) * along[j])); }
      });
      values.push(sign > 0 ? 1 + u[k] : 2 - u[k]);
      slopes.push(domain.free.map((_, j) => j === k ? sign : 0));
      return { values: keep.map((i) => values[i]), slopes: keep.map((i) => slopes[i]) };
    };
    const set = level(domain, rise, keep.map((i) => asked[i]), 1e-7, true);
    const u = set.nearest(from, from);
    return u && set.isMet(u) ? u : null;
  };

  // The furthest that a parameter goes in the direction of `sign`, from the solution and others that are as good.
  const HALVINGS = 9;
  const furthest = (meets, k, sign, known) => {
    let best = known.reduce((a, b) => sign * b[k] > sign * a[k] ? b : a);
    const edge = sign > 0 ? 1 : 0;
    if (meets(k, sign, edge, best)) return edge;
    let beyond = edge;
    for (let turn = 0; turn < HALVINGS; turn++) {
      const middle = 0.5 * (best[k] + beyond), found = meets(k, sign, middle, best);
      if (found) best = found; else beyond = middle;
    }
    return Math.min(Math.max(best[k], 0), 1);
  };

  // The solution of a set of aims: `point` gives what is held, `held` which parameters are.
  const solve = (model, aims, point, held, others = 24) => {
    const domain = Box.domain(model, point, held);
    const rise = responses(model, domain, aims), bands = aims.map(({ low, high }) => [low, high]);
    const target = level(domain, rise, bands), preference = domain.centre();
    const apart = (u) => Numeric.norm(u.map((x, i) => x - preference[i]));
    const met = (set, u) => u && set.isMet(u) ? u : null;
    let anchor = met(target, target.nearest(preference, preference)), set = target, wanted = bands;
    const least = anchor ? null : minimise(model, domain, aims, [preference]);
    if (!anchor) anchor = met(target, target.nearest(least.u, least.u));
    if (!anchor) {
      // The targets cannot be met together: as near as can be is what the best place gives.
      anchor = least.u;
      wanted = rise(anchor).values.map((y) => [y, y]);
      set = level(domain, rise, wanted);
    }
    const starts = [anchor, ...places(domain, 3)];
    const found = starts.map((start) => met(set, set.nearest(start, preference))).filter(Boolean);
    const chosen = found.reduce((best, u) => apart(u) < apart(best) - 1e-9 ? u : best, found[0] ?? anchor);
    const sample = places(domain, others).map((place) => met(set, set.nearest(chosen, place))).filter(Boolean);
    const x = domain.at(chosen), values = aims.map(({ response }) => Surface.value(model.responses[response], x));
    return { domain, aims, unit: chosen, point: x, values, misfit: misfit(model, aims, values), deviations: deviations(model, aims, values),
             isMet: set === target, free: domain.size - Numeric.rank(set.active(chosen)), sample, others: sample.map(domain.at), bands: wanted };
  };

  // What one parameter can be, and which targets tie it: those without which it goes further. Asked after the solution,
  // parameter by parameter, since it takes longer.
  const TIED = 0.1;
  const determine = (model, found, i) => {
    const { domain, aims, unit, sample, values } = found, parameter = model.parameters[i], k = domain.free.indexOf(i);
    if (k < 0) return { word: "held", low: found.point[i], high: found.point[i], by: [] };
    const bands = aims.map(({ low, high }, j) => low !== high && values[j] >= low && values[j] <= high ? [low, high] : [values[j], values[j]]);
    const meets = probe(model, domain, aims, bands), known = [unit, ...sample];
    const [low, high] = [furthest(meets, k, -1, known), furthest(meets, k, 1, known)];
    const sure = aims.some(({ response }) => model.responses[response].s > 0), part = high - low;
    const word = part >= model.free ? "free" : !sure ? "unknown" : part <= model.determined ? "determined" : "partly determined";
    const loosens = (_, j) => {
      const rest = (list) => list.filter((_, other) => other !== j);
      if (aims.length === 1) return true;
      const without = probe(model, domain, rest(aims), rest(bands));
      return high < 1 && without(k, 1, Math.min(high + TIED, 1), unit) !== null || low > 0 && without(k, -1, Math.max(low - TIED, 0), unit) !== null;
    };
    const by = word === "free" ? [] : aims.filter(loosens).map(({ response }) => response);
    return { word, low: Box.natural(parameter, low), high: Box.natural(parameter, high), by };
  };

  // What every response can be.
  const reaches = (model, point, held) => { const domain = Box.domain(model, point, held); return model.responses.map((surface) => reach(surface, domain)); };
  const within = (model, { low, high, response, tolerance }, y) => {
    const slack = (end) => Number.isFinite(end) ? (tolerance ?? model.tolerance) * Math.abs(end) : 0;
    return y >= low - slack(low) && y <= high + slack(high);
  };
  return { solve, determine, reaches, within };
})();
