// Tables wider than the column take the keyboard focus: its arrows scroll them.
addEventListener("load", () => {
  const focus = () => {
    for (const box of document.querySelectorAll(".md-typeset__scrollwrap")) {
      const scrolls = box.scrollWidth > box.clientWidth;
      if (scrolls) box.setAttribute("tabindex", "0");
      else box.removeAttribute("tabindex");
    }
  };
  focus();
  addEventListener("resize", focus);
});
