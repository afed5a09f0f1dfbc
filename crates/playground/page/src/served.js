// Scripts of a folder, as `standstill serve` gives them out: opened, and read again whenever one of their files is saved.

const PERIOD = 300; // ms between two looks

let followed = null; // what is asked for, and how it was last

// Ends the looks: another script is open.
export function forget() {
  followed = null;
}

async function ask(path, tag) {
  const address = new URL(`../folder/${path.split('/').map(encodeURIComponent).join('/')}`, import.meta.url);
  const answer = await fetch(address, { cache: 'no-store', headers: tag ? { 'If-None-Match': tag } : {} });
  if (answer.status === 304) return null;
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return { tag: answer.headers.get('ETag'), project: await answer.json() };
}

async function look(mine) {
  const { path, saved, trouble } = mine;
  try {
    // Nobody looks at a page that is behind others.
    const answer = document.hidden ? null : await ask(path, mine.tag);
    if (mine !== followed) return;
    if (mine.lost) trouble('');
    mine.lost = false;
    if (answer) {
      mine.tag = answer.tag;
      saved(answer.project);
    }
  } catch (error) {
    if (mine !== followed) return;
    mine.lost = true;
    trouble(error instanceof TypeError ? 'The program `standstill serve` does not answer any more: what is open here stays.' : error.message);
  }
  setTimeout(() => mine === followed && look(mine), mine.lost ? 10 * PERIOD : PERIOD);
}

// Opens the script at a path of the folder by `opened(project)`, and calls `saved(project)` whenever it is another one.
export async function follow(path, { opened, saved, trouble }) {
  let answer;
  try {
    answer = await ask(path, null);
  } catch (error) {
    trouble(error.message);
    return false;
  }
  const mine = { path, saved, trouble, tag: answer.tag, lost: false };
  document.querySelector('#pick').value = `/${path}`;
  // It forgets what was followed before.
  const done = opened(answer.project);
  followed = mine;
  setTimeout(() => mine === followed && look(mine), PERIOD);
  await done;
  return true;
}
