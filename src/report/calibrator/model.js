// The fitted surfaces: value, slopes, interval of the mean and of one run, and whether a point lies beyond what was run.
// A surface is a polynomial in coded units; the rows of `root` span the covariance of its coefficients.
const Surface = (() => {
  // Terms and their slopes along the surface's own axes, at a point in the units of the parameters.
  const basis = (surface, point) => {
    const { axes, powers } = surface;
    const coded = axes.map((axis) => (point[axis.parameter] - axis.centre) / axis.half);
    const terms = powers.map((own) => {
      let product = 1;
      for (let i = 0; i < own.length; i++) for (let p = 0; p < own[i]; p++) product *= coded[i];
      return product;
    });
    const slope = (own, along) => {
      if (own[along] === 0) return 0;
      let product = own[along];
      for (let i = 0; i < own.length; i++) for (let p = i === along ? 1 : 0; p < own[i]; p++) product *= coded[i];
      return product / axes[along].half;
    };
    return { terms, slopes: () => axes.map((_, along) => powers.map((own) => slope(own, along))) };
  };
  const sum = (terms, coefficients) => { let total = 0; for (let i = 0; i < terms.length; i++) total += terms[i] * coefficients[i]; return total; };
  // The entries whose squares add up to the leverage.
  const spread = (root, terms) => terms.map((_, j) => {
    let entry = 0;
    for (let i = 0; i <= j; i++) entry += terms[i] * root[i * terms.length + j];
    return entry;
  });

  const value = (surface, point) => sum(basis(surface, point).terms, surface.coefficients);

  // Everything that is said of a point.
  const predict = (surface, point) => {
    const { terms } = basis(surface, point);
    const mean = sum(terms, surface.coefficients);
    let leverage = 0;
    for (const entry of spread(surface.root, terms)) leverage += entry * entry;
    const about = (share) => {
      if (surface.s === null) return [NaN, NaN];
      const reach = surface.quantile * surface.s * Math.sqrt(share);
      return [mean - reach, mean + reach];
    };
    const outside = surface.axes.filter((axis) => point[axis.parameter] < axis.low || point[axis.parameter] > axis.high);
    return { value: mean, interval: about(leverage), run: about(1 + leverage),
             outside: outside.map((axis) => axis.parameter), far: leverage > surface.farthest * (1 + 1e-9) };
  };

  // Value and interval ends with their slopes along all parameters.
  const rise = (surface, point, count) => {
    const { terms, slopes } = basis(surface, point);
    const entries = spread(surface.root, terms), own = slopes();
    const leverage = Numeric.dot(entries, entries);
    const scale = surface.s === null ? 0 : surface.quantile * surface.s;
    const reach = scale * Math.sqrt(leverage);
    const mean = sum(terms, surface.coefficients);
    const slope = new Array(count).fill(0), widening = new Array(count).fill(0);
    surface.axes.forEach((axis, along) => {
      slope[axis.parameter] += sum(own[along], surface.coefficients);
      if (leverage > 0) widening[axis.parameter] += scale * Numeric.dot(entries, spread(surface.root, own[along])) / Math.sqrt(leverage);
    });
    return { value: mean, reach, slope, widening };
  };

  return { value, predict, rise };
})();
