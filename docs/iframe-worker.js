// Search from a folder: browsers start no worker from a file, so the worker of the search runs in a hidden frame.
class FrameWorker extends EventTarget {
  constructor(address) {
    super();
    const frame = document.createElement('iframe');
    frame.hidden = true;
    document.body.append(frame);
    this.scope = frame.contentWindow;
    this.scope.document.open();
    this.scope.document.write('<!doctype html><html><body></body></html>');
    this.scope.document.close();
    this.scope.postMessage = data => this.dispatchEvent(new MessageEvent('message', { data }));
    this.scope.importScripts = async (...addresses) => {
      for (const next of addresses) await this.load(next);
    };
    this.loaded = this.load(address);
  }

  load(address) {
    const script = this.scope.document.createElement('script');
    return new Promise((resolve, reject) => {
      Object.assign(script, { src: address, onload: resolve, onerror: reject });
      this.scope.document.body.append(script);
    });
  }

  async postMessage(data) {
    await this.loaded;
    this.scope.dispatchEvent(new MessageEvent('message', { data }));
  }

  terminate() {
    this.scope.frameElement.remove();
  }
}

if (location.protocol === 'file:') window.Worker = FrameWorker;
