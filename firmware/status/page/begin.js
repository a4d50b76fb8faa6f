// Begins the page: a browser gives up what it is loading where its network changes, and a page of which
// one part has not come never runs. Such a page is loaded again.
const pauseMs = 5000;

// Of a sheet that has not come some browsers have none, and others one whose rules nobody may read.
function isStyled() {
  try {
    return document.querySelector("link[rel=stylesheet]").sheet.cssRules.length > 0;
  } catch {
    return false;
  }
}

function say(text) {
  const lost = document.getElementById("lost");
  lost.textContent = text;
  lost.hidden = false;
}

// Where nothing answers, the browser would put its own page in the place of this one.
async function isAnswered() {
  try {
    const answer = await fetch("status.json", { cache: "no-cache", signal: AbortSignal.timeout(pauseMs) });
    return answer.ok;
  } catch {
    return false;
  }
}

async function loadAgain() {
  say("Not all of this page has come from the gateway. It is loaded again when the gateway answers.");
  do {
    await new Promise((done) => setTimeout(done, pauseMs));
  } while (!await isAnswered());
  location.reload();
}

addEventListener("load", () => {
  if (!isStyled()) loadAgain();
});
import("./main.js").catch((error) => {
  console.info(String(error));
  // What has come and cannot be run would not be run the next time either.
  if (error instanceof SyntaxError) say(`This browser is too old for this page: ${error.message}.`);
  else loadAgain();
});
