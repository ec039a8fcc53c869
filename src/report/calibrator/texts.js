// The parameters as text: a profile that is laid over the workflow, and commands for PFC.
const Texts = (() => {
  // Nine digits are more than any surface knows.
  const plain = (x) => String(Number(x.toPrecision(9)));
  const bare = (key) => /^[A-Za-z0-9_-]+$/.test(key) ? key : JSON.stringify(key);
  const quantity = (x, unit) => unit ? JSON.stringify(plain(x) + " " + unit) : plain(x);
  const comment = (mark, text) => mark + " " + text.replace(/\s+/g, " ");
  const SI = { GPa: 1e9, MPa: 1e6, kPa: 1e3, Pa: 1, "": 1, "GPa/m": 1e9, "MPa/m": 1e6, "Pa/m": 1, "N/m": 1, "kN/m": 1e3, "MN/m": 1e6,
               rad: 1, deg: Math.PI / 180, "°": Math.PI / 180, "%": 0.01 };

  const toml = (model, point, words) => {
    const sets = model.parameters.some((parameter) => parameter.sets.length);
    const how = sets
      ? ["Add these lines to " + model.file + " and run it with --profile calibrated.",
         "A stage whose design varies these parameters stays at the values of its design; a test without a design has these."]
      : ["These parameters set nothing in the workflow: they are values of a formula or a table."];
    const lines = [comment("#", "Found with the calibrator of " + model.title + ": " + words + "."), ...how.map((line) => comment("#", line)), ""];
    const tables = new Map();
    const put = (table, key, i) => tables.set(table, [...(tables.get(table) ?? []), [key, i]]);
    model.parameters.forEach((parameter, i) => {
      for (const path of parameter.sets) {
        const [first, ...rest] = path.split(".");
        const homes = model.materials.filter((material) => material.entries.some((entry) => entry.name === first));
        for (const { name } of homes) put(["profile", "calibrated", "material", name], [first, ...rest], i);
        // What no material has is set in a stage.
        if (!homes.length && rest.length) put(["profile", "calibrated", "stage", first], rest, i);
      }
      if (!parameter.sets.length) lines.push(comment("#", parameter.name + " = " + plain(point[i]) + " " + parameter.unit));
    });
    const named = new Map();
    for (const [table, rows] of tables) {
      const head = "[" + table.map(bare).join(".") + "]";
      named.set(head, [...(named.get(head) ?? []), ...rows]);
    }
    for (const [head, rows] of named) {
      lines.push(head, ...rows.map(([key, i]) => key.map(bare).join(".") + " = " + quantity(point[i], model.parameters[i].unit)), "");
    }
    return lines.join("\n").trimEnd() + "\n";
  };

  // The property names of PFC's linear parallel bond; a modulus without one of its own for the bond is that of both.
  const commands = (values, bonded, range) => {
    const has = (key) => values[key] !== undefined, n = (key) => plain(values[key]);
    const lines = [];
    if (has("Ec") && has("kn_ks")) lines.push("contact method deformability emod " + n("Ec") + " kratio " + n("kn_ks") + range);
    if (has("kn") && has("ks")) lines.push("contact property kn " + n("kn") + " ks " + n("ks") + range);
    if (bonded) {
      const modulus = has("pb_Ec") ? "pb_Ec" : "Ec", ratio = has("pb_kn_ks") ? "pb_kn_ks" : "kn_ks";
      if (has(modulus) && has(ratio)) lines.push("contact method pb_deformability emod " + n(modulus) + " kratio " + n(ratio) + range);
      const strengths = [["sigma_c", "pb_ten"], ["tau_c", "pb_coh"]].filter(([key]) => has(key)).map(([key, name]) => name + " " + n(key));
      if (strengths.length) lines.push("contact property " + strengths.join(" ") + range);
    }
    if (has("mu")) lines.push("contact property fric " + n("mu") + range);
    const written = ["Ec", "kn_ks", "kn", "ks", "pb_Ec", "pb_kn_ks", "sigma_c", "tau_c", "mu"];
    const left = Object.keys(values).filter((key) => !written.includes(key));
    if (left.length) lines.push(comment(";", "not written, see PFC's manual: " + left.map((key) => key + " = " + n(key)).join(", ")));
    return lines;
  };

  const pfc = (model, point, words) => {
    const lines = [comment(";", "Found with the calibrator of " + model.title + ": " + words + "."),
                   "; SI units. For contacts with the model linearpbond, after `contact method bond`; the groups are those of the contacts."];
    for (const material of model.materials) {
      for (const entry of material.entries) {
        const values = Object.assign(Object.create(null), entry.values); // any name may be a key
        let unknown = false;
        model.parameters.forEach((parameter, i) => {
          for (const path of parameter.sets) if (path.startsWith(entry.name + ".")) {
            const scale = SI[parameter.unit];
            if (scale === undefined) unknown = true;
            else values[path.slice(entry.name.length + 1)] = point[i] * scale;
          }
        });
        const name = entry.name.replace(/[^\w -]/g, "_");
        lines.push("", comment(";", entry.groups.join(" with ") + (entry.bonded ? "" : ", not bonded") + (unknown ? ", some units are unknown here" : "")),
          ...commands(values, entry.bonded, " range group '" + name + "'"));
      }
    }
    if (!model.materials.length) model.parameters.forEach((parameter, i) => lines.push(comment(";", parameter.name + " = " + plain(point[i]) + " " + parameter.unit)));
    return lines.join("\n") + "\n";
  };

  return { toml, pfc, plain };
})();
