// asked of the page of a scene
({
  // arrays by name, or the error message
  simulate: options => {
    try {
      const found = window.inertiaModule.simulate(options);
      return Object.fromEntries(Object.entries(found).map(([name, array]) => [name, [...array]]));
    } catch (error) {
      return error.message;
    }
  },
  // the run at its end, by the page's integrate in slices
  integrate: request => new Promise(done => {
    let calls = 0;
    window.inertiaModule.integrate(request, run => {
      calls++;
      if (run.complete || run.error !== null) {
        const columns = Object.entries(run.columns).map(([name, array]) => [name, [...array]]);
        done({ ...run, columns: Object.fromEntries(columns), time: [...run.time], calls });
      }
    });
  }),
  // speed at the end of the last of a thousand and one runs, as many rejected in between
  thousand: ([good, bad]) => {
    const { simulate } = window.inertiaModule;
    for (let n = 0; n < 1000; n++) {
      simulate(good);
      try { simulate(bad); } catch { /* rejected */ }
    }
    return simulate(good).omega_out.at(-1);
  },
  // column of the run that is shown
  shown: name => {
    const { run } = inertiaModule.state();
    return [...(name === "time" ? run.time : run.columns[name])];
  },
  // the run that is played, between its rows
  played: async () => {
    const { start, playable } = window.inertiaModule;
    const { time, columns } = await playable(start.run, start.scene.parameters);
    return { time: [...time], omega_out: [...columns.omega_out], q: [...columns.q] };
  },
  // numbers beside the speeds
  legend: () => [...document.querySelectorAll('.panel:first-child .legend output')].map(cell => cell.textContent),
  // scenes that can be chosen
  scenes: () => [...document.querySelectorAll('select[aria-label=Scene] option')].map(one => one.value),
  // boxes narrower than what is in them, all settings unfolded
  tooNarrow: () => {
    document.querySelectorAll('details').forEach(group => { group.open = true; });
    return [...document.querySelectorAll('body *:not(svg *)')].filter(
      box => getComputedStyle(box).display !== 'inline' && box.scrollWidth > box.clientWidth + 1
    ).map(box => `${box.tagName} ${box.className}: ${box.textContent.slice(0, 60)}`);
  },
})
