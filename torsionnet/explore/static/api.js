// Questions to the server that this page came from. Addresses are relative: the token stands in the page's own path.

let pending = 0;

// How many questions are under way.
export function underWay() {
  return pending;
}

export async function ask(question, state = {}) {
  pending += 1;
  try {
    const reply = await fetch(`api/${question}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(state),
    }).catch(() => {
      throw new Error("No answer: torsionnet explore has ended. Start it again and open the address it prints.");
    });
    const data = await reply.json();
    if (!reply.ok) throw new Error(data.error);
    return data;
  } finally {
    pending -= 1;
  }
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
      show(await ask(question, state), state, since);
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
