// Plays the instants of the particles or of the map. `next` shows the next one and returns how long it stays [ms].
"use strict";

window.talus_player = (button, next) => {
  let playing = null;  // one object for each time it is played: what an earlier one began ends there
  const play = (on) => {
    const mine = playing = on ? {} : null;
    button.textContent = on ? "Pause" : "Play";
    const go = async () => { if (playing === mine) setTimeout(go, await next()); };
    if (on) go();
  };
  const press = () => play(playing === null);
  button.addEventListener("click", press);
  return {press, stop: () => play(false)};
};
