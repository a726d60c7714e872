"use strict";
(() => {
  const form = document.getElementById("filters");
  if (!form) return;
  const cards = [...document.querySelectorAll(".card")];
  const count = document.getElementById("count");
  const none = document.getElementById("none");
  const fields = [...form.querySelectorAll("select")];

  const fits = (card, field) => {
    const wanted = field.value;
    if (wanted === "") return true;
    if (field.name === "pick" && wanted === "any") return card.dataset.pick !== "";
    return card.dataset[field.name] === wanted;
  };
  const apply = () => {
    let shown = 0;
    for (const card of cards) {
      card.hidden = !fields.every((field) => fits(card, field));
      if (!card.hidden) shown += 1;
    }
    count.textContent = shown + " of " + cards.length + " shown";
    none.hidden = shown > 0;
  };

  form.addEventListener("change", apply);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(apply, 0));
  form.hidden = false;
  apply();
})();
