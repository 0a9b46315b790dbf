// A table that is wider than the page says that it scrolls.
for (const box of document.querySelectorAll(".table")) {
  const mark = () => box.classList.toggle("scrolls", box.scrollWidth > box.clientWidth + 1);
  new ResizeObserver(mark).observe(box);
  box.addEventListener("toggle", mark);
}
