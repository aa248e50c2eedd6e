/* Starts the page, or says why it cannot. */

function complain(text) {
  const problem = document.getElementById("problem");
  problem.textContent = text;
  problem.hidden = false;
}

if (typeof WebAssembly === "undefined") {
  complain("This browser has no WebAssembly, or it is switched off. Nothing can be lifted without it.");
} else {
  import("./main.js").catch((error) => {
    console.error(error);
    complain(`The page does not start: ${error.message}`);
  });
}
