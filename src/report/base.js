"use strict";
// What every page needs: elements, the theme, copying.
const Page = (() => {
  const make = (tag, more = {}, ...inside) => {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(more)) {
      if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
      else if (value !== undefined) element.setAttribute(name, value);
    }
    element.append(...inside);
    return element;
  };
  const all = (what, root = document) => [...root.querySelectorAll(what)];

  // Theme: as the system has it, or as chosen.
  const themes = ["auto", "light", "dark"];
  const kept = { get: () => { try { return localStorage.getItem("theme"); } catch { return null; } },
                 set: (value) => { try { localStorage.setItem("theme", value); } catch { /* a page without memory */ } } };
  const theme = make("button", { type: "button" });
  const choose = (name) => {
    if (name === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = name;
    theme.textContent = "Theme: " + name;
    theme.dataset.name = name;
  };
  theme.addEventListener("click", () => {
    const next = themes[(themes.indexOf(theme.dataset.name) + 1) % themes.length];
    choose(next);
    kept.set(next);
  });
  choose(themes.includes(kept.get()) ? kept.get() : "auto");
  document.getElementById("tools").append(theme);

  // Copying.
  const copy = async (text) => {
    try { await navigator.clipboard.writeText(text); return true; } catch { /* an older way below */ }
    const area = make("textarea", { "aria-hidden": "true", tabindex: "-1" });
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  };
  // Text, and the same as a page where the receiver takes it.
  const both = async (text, html) => {
    const blob = (data, type) => new Blob([data], { type });
    try {
      await navigator.clipboard.write([new ClipboardItem({ "text/plain": blob(text, "text/plain"), "text/html": blob(html, "text/html") })]);
      return true;
    } catch { /* an older way below */ }
    const put = (event) => {
      event.clipboardData.setData("text/plain", text);
      event.clipboardData.setData("text/html", html);
      event.preventDefault();
    };
    document.addEventListener("copy", put);
    const done = document.execCommand("copy");
    document.removeEventListener("copy", put);
    return done;
  };
  const copier = (name, text, output, html) => make("button", { type: "button", onclick: async () => {
    const done = html ? await both(text(), html()) : await copy(text());
    output.textContent = done ? "copied" : "copying is not allowed here";
    setTimeout(() => { output.textContent = ""; }, 2500);
  } }, name);

  return { make, all, copy, copier };
})();
