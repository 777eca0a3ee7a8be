// Questions to the server that this page came from. Addresses are relative: the token stands in the page's own path.

let pending = 0;
let named = {};

// How many questions are under way.
export function underWay() {
  return pending;
}

// From now on every question is about this document.
export function askAbout(document) {
  named = { document };
}

export async function ask(question, state = {}) {
  pending += 1;
  try {
    return await quietly(question, state);
  } finally {
    pending -= 1;
  }
}

// A question that nothing waits for, such as whether the file has changed.
export async function quietly(question, state = {}) {
  const reply = await fetch(`api/${question}`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ ...named, ...state }),
  }).catch(() => {
    throw new Error("No answer: torsionnet explore has ended. Start it again and open the address it prints.");
  });
  const data = await reply.json();
  if (!reply.ok) throw new Error(data.error);
  return data;
}

// While one question is under way only the latest state waits: a slider never queues up work that nobody will see.
export function newestOnly(question, show, fail) {
  let busy = false;
  let waiting = null;
  async function next() {
    const { state, since } = waiting;
    waiting = null;
    busy = true;
    try {
      const answer = await ask(question, state);
      if (!answer.superseded) show(answer, state, since);
    } catch (error) {
      fail(error);
    }
    busy = false;
    if (waiting) next();
  }
  return (state, since) => {
    waiting = { state, since };
    if (!busy) next();
  };
}
