// The page: text, schematic, results and values, each following the others.

import { ask, newestOnly } from "./api.js";
import { markModes, modesAreChosen } from "./modes.js";
import { drawMasses } from "./masses.js";
import { makeMotion } from "./motion.js";
import { makePanes } from "./panes.js";
import { results } from "./results.js";
import { makeSchematic } from "./schematic.js";
import { openText } from "./writing.js";

const CALM = 120; // ms; a drawing and its motion need not follow every step of a slider
const at = (id) => document.getElementById(id);

const nonce = document.querySelector("meta[name=style-nonce]").content;
const panes = makePanes();
let writing = null;
let later = 0;
const motion = makeMotion((shown) => markModes(at("modes"), shown));
modesAreChosen(motion.choose);
const schematic = makeSchematic(at("schematic"), {
  drawn: motion.on,
  moved: motion.look,
  choose: (kind, name) => {
    panes.show("text");
    writing?.goTo(kind, name);
  },
});
const quiet = () => {}; // what cannot be drawn is told by the answer about results already
const drawing = newestOnly("schematic", (found) => found.svg && schematic.show(found), quiet);
const moving = newestOnly("motion", (found) => {
  if (!found.modes) return;
  motion.show(found);
  drawMasses(at("masses"), found.elements);
}, quiet);

let drawnFor = "";

results.begin((state, isNewModel) => {
  writing?.button();
  clearTimeout(later);
  const key = JSON.stringify(state.choice);
  later = setTimeout(() => {
    drawing(state);
    moving(state);
  }, isNewModel || key !== drawnFor ? 0 : CALM);
  drawnFor = key;
});

writing = await openText(nonce, schematic);
const model = await ask("model");
if (model.refused) results.refuse(model.refused);
else results.show(model);
writing.begin();
