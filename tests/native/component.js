// runs of the component in Chromium, transpiled by jco: rows of each
async ({ code, modules, runs }) => {
  const url = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
  const { instantiate } = await import(url);
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const compile = (name) => WebAssembly.compile(bytes(modules[name]));
  const found = await instantiate(compile, { "fmi:fmi3/callbacks": { logMessage() {} } });
  const { CoSimulationInstance } = found.coSimulation;
  return runs.map(({ token, set, events, step, steps, references }) => {
    const make = CoSimulationInstance.instantiateCoSimulation;
    const fmu = make("one", token, "", false, true, events, events, []);
    const types = { float64: Float64Array, int32: Int32Array, int64: BigInt64Array, boolean: Array };
    const calls = { float64: "setFloat64", int32: "setInt32", int64: "setInt64", boolean: "setBoolean" };
    for (const [type, reference, value] of set) {
      const own = type === "int64" ? BigInt(value) : type === "boolean" ? Boolean(value) : value;
      fmu[calls[type]](new Uint32Array([reference]), types[type].from([own]));
    }
    fmu.enterInitializationMode(undefined, 0, undefined);
    fmu.exitInitializationMode();
    if (events) fmu.enterStepMode();
    const rows = [];
    for (let reached = 0; reached < steps * step - 1e-9; ) {
      const done = fmu.doStep(reached, step * (Math.floor(reached / step + 1e-6) + 1) - reached, true);
      reached = done.lastSuccessfulTime;
      if (done.eventHandlingNeeded) {
        fmu.enterEventMode();
        fmu.updateDiscreteStates();
        fmu.enterStepMode();
      }
      rows.push([reached, ...fmu.getFloat64(new Uint32Array(references))]);
    }
    return rows;
  });
}
