/**
 * Search without a server: a browser starts no worker from a page that was opened as a file, so there the worker's script runs in a
 * hidden frame instead, which takes and sends messages as a worker does. From a server nothing is changed.
 */
class IFrameWorker extends EventTarget {
  constructor(address) {
    super();
    this.frame = document.createElement("iframe");
    this.frame.hidden = true;
    document.body.append(this.frame);
    this.inside = this.frame.contentWindow;
    this.ready = new Promise((resolve) => {
      const script = this.inside.document.createElement("script");
      script.src = new URL(address, document.baseURI);
      script.onload = resolve;
      this.inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      this.inside.document.body.append(script);
    });
  }

  postMessage(data) {
    this.ready.then(() => this.inside.dispatchEvent(new this.inside.MessageEvent("message", { data })));
  }

  terminate() {
    this.frame.remove();
  }
}

if (location.protocol === "file:") {
  window.IFrameWorker = IFrameWorker;
  window.Worker = IFrameWorker;
}
