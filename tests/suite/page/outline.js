// The structure of the page, an element a line: tag, classes, role, label, and what a reader sees of short texts.
(() => {
  const skipped = new Set(["SCRIPT", "STYLE", "META"]);
  const lines = [];
  const walk = (element, depth) => {
    if (skipped.has(element.tagName)) return;
    const names = [...element.classList].map((name) => "." + name).join("");
    const id = element.id ? "#" + element.id : "";
    const label = ["role", "aria-label", "scope", "type"].map((name) => element.getAttribute(name) ? ` ${name}=${element.getAttribute(name)}` : "").join("");
    const own = [...element.childNodes].filter((node) => node.nodeType === 3).map((node) => node.textContent.trim()).join(" ").trim()
      // A program's folder is another one on each machine.
      .replace(/^'?[^']*\/fumarole'? /, "fumarole ");
    lines.push("  ".repeat(depth) + element.tagName.toLowerCase() + id + names + label + (own ? ": " + own.replace(/\s+/g, " ").slice(0, 60) : ""));
    for (const child of element.children) walk(child, depth + 1);
  };
  walk(document.documentElement, 0);
  return lines.join("\n") + "\n";
})()
