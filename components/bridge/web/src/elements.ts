// SPDX-License-Identifier: Apache-2.0
// Elements of the page by their id.

// Throws an Error when the page has no such element.
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element as T;
}

// Sets the text of an element, if it differs.
export function put(id: string, text: string): void {
  const element = byId(id);
  if (element.textContent !== text) element.textContent = text;
}
