// One line at the foot of the page about what has just been done; it is read aloud and goes by itself.

const SECONDS = 6;
let going = 0;

export function say(text) {
  const place = document.getElementById("said");
  place.textContent = text;
  clearTimeout(going);
  going = setTimeout(() => (place.textContent = ""), 1000 * SECONDS);
}
