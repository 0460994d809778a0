// SPDX-License-Identifier: GPL-3.0-or-later
// What both pages have: title, origin. Then the page of the kind of data there is.

function showOrigin() {
  const {origin} = data, runLines = (data.provenance_of_run ?? []).filter(([, text]) => text);
  byId('name').textContent = origin.name;
  const details = element(
      'details', {}, element('summary', {}, 'Where these numbers come from'),
      element('p', {}, 'The case, as it was resolved:'), element('pre', {tabindex: 0}, origin.case));
  for (const [key, text] of runLines)
    details.append(element('p', {}, `Of the run, ${key.replaceAll('_', ' ')}:`), element('pre', {}, text.trim()));
  details.append(element('p', {}, 'Libraries:'), element('pre', {}, origin.libraries.trim()));
  byId('origin').append(
      element(
          'p', {}, `${origin.program}, written by `, element('code', {}, origin.command_line),
          '. Equal runs give equal bytes.'),
      details);
}

showOrigin();
document.querySelectorAll('form').forEach((form) => form.addEventListener('submit', (event) => event.preventDefault()));
if (data.kind === 'packing')
  showPacking();
else
  showRun();
