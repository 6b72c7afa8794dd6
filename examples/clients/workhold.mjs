// A client of workhold serve for node (18 or later) and for pages of any site: fetch and nothing else.

const OVER = ["done", "failed", "cancelled"];
// Connections in a row that bring nothing, until the server is given up.
const TRIES = 5;

export class Workhold {
  /** server: its address; token: of a server that asks for one. */
  constructor(server = "http://127.0.0.1:8000", token = null) {
    this.server = server;
    this.token = token;
  }

  /** Asks for something; what the server refuses is thrown with the server's sentence. */
  async ask(path, options = {}) {
    const headers = { ...options.headers };
    if (this.token) headers.Authorization = `Bearer ${this.token}`;
    const answer = await fetch(this.server + path, { ...options, headers });
    if (!answer.ok) throw new Error((await answer.json()).error);
    return answer;
  }

  /** Sends JSON and receives JSON. */
  async send(path, content) {
    const headers = { "Content-Type": "application/json" };
    return (await this.ask(path, { method: "POST", headers, body: JSON.stringify(content) })).json();
  }

  /** The part that a file holds: its bytes or a Blob, and its name. */
  async read(content, name) {
    const headers = { "X-Filename": encodeURIComponent(name) };
    const survey = await (await this.ask("/api/v1/parts/survey", { method: "POST", headers, body: content })).json();
    if (survey.error) throw new Error(survey.error);
    return { name: survey.part.name, loops: survey.part.loops, departure: survey.part.departure };
  }

  /** Begins a search, which is cancelled when nobody follows it; the address of its job. */
  async begin(workpiece, toolkit) {
    return (await this.send("/api/v1/jobs?when_left=cancel", { workpiece, toolkit })).url;
  }

  /** The states of a job until it is over; a stream that breaks goes on after the last event that came. */
  async *states(job, signal) {
    let seen = "";
    let failed = 0;
    for (let over = false; !over; ) {
      try {
        const answer = await this.ask(`${job}/events`, { headers: { "Last-Event-ID": seen }, signal });
        const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
        let text = "";
        for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
          const blocks = (text + piece.value).split("\n\n");
          text = blocks.pop();
          for (const block of blocks) {
            const lines = block.split("\n").map((line) => line.split(/: (.*)/));
            const event = Object.fromEntries(lines);
            if (!event.data) continue;
            seen = event.id;
            failed = 0;
            const state = JSON.parse(event.data);
            over = OVER.includes(state.state);
            yield state;
          }
        }
      } catch (error) {
        // What the network does is tried again; what the server refuses, and who gives up, ends it.
        failed += 1;
        if (!(error instanceof TypeError) || failed === TRIES) throw error;
        await new Promise((resume) => setTimeout(resume, 1000));
      }
    }
  }

  /** Finds every fixture: the address of the job and its first choices; tell is called with each state. */
  async design(workpiece, toolkit, tell = () => {}) {
    const job = await this.begin(workpiece, toolkit);
    let last;
    for await (last of this.states(job)) tell(last);
    if (last.state !== "done") throw new Error(last.error ?? "The search was cancelled.");
    const page = await (await this.ask(`${job}/fixtures?limit=3`)).json();
    return { job, rows: page.rows };
  }

  /** The setup sheet of a fixture as a PDF. */
  async sheet(job, rank) {
    return (await this.ask(`${job}/fixtures/${rank}/sheet.pdf?jaw_force=3000`)).blob();
  }

  /** Forgets a job. */
  async forget(job) {
    await this.ask(job, { method: "DELETE" });
  }
}

/** A row of the list in words. */
export const words = (row) =>
  `${row.rank} ${row.holes.join(" ")} ${row.quality.location_error.toFixed(3)} mm`;
