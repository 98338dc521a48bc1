// SPDX-License-Identifier: GPL-3.0-or-later
// "Copy a link" of the project's menu: to the clipboard, or in a dialog why not.
import { Button, Dialog, toast } from '../../ui';
import type { ProjectLink } from './project_link';
import { listed } from './project_link';

/** Of this copy of the page, without what else its address holds. */
const addressOf = (link: string): string => location.origin + location.pathname + link;

/** Served from this computer, as by the worker program, the page is at no address that others reach. */
const isHere = (): boolean => /^(localhost|127\.\d+\.\d+\.\d+|\[::1\])$/.test(location.hostname);

function sentence(leftOut: readonly string[]): string {
  const without =
    leftOut.length > 0 ? ` It leaves out ${listed(leftOut)}; a project file has everything.` : '';
  const here = isHere()
    ? ' Its address is this computer’s: elsewhere put the part from # on behind the address of another copy of the page.'
    : '';
  return `Link copied.${without}${here}`;
}

/** What the menu says beside the item. */
export const hintOf = (link: ProjectLink): string | undefined =>
  'reason' in link ? link.reason : link.leftOut.length > 0 ? `without ${listed(link.leftOut)}` : undefined;

/** False where the browser gives no access to the clipboard: the link is to be shown. */
export async function copyLink(link: ProjectLink): Promise<boolean> {
  if (!('link' in link)) return false;
  try {
    await navigator.clipboard.writeText(addressOf(link.link));
  } catch {
    return false;
  }
  toast(sentence(link.leftOut));
  return true;
}

export interface LinkDialogProps {
  readonly link: ProjectLink;
  readonly onSaveAsFile: () => void;
  readonly onClose: () => void;
}

/** The link to be copied by hand, or why there is none and what to do instead. */
export function LinkDialog({ link, onSaveAsFile, onClose }: LinkDialogProps) {
  if ('link' in link)
    return (
      <Dialog title="Copy this link" onClose={onClose}>
        <p>The browser gives no access to the clipboard. Copy the link from here.</p>
        <input
          class="text-field"
          readonly
          aria-label="Link"
          value={addressOf(link.link)}
          onFocus={(event) => event.currentTarget.select()}
          autoFocus
        />
        {link.leftOut.length > 0 ? (
          <p>It leaves out {listed(link.leftOut)}. A project file has everything.</p>
        ) : null}
      </Dialog>
    );
  return (
    <Dialog title="No link to this project" onClose={onClose}>
      <p>{link.sentence}</p>
      <div class="row end">
        <Button onClick={onClose}>Close</Button>
        <Button
          kind="filled"
          icon="download"
          onClick={() => {
            onClose();
            onSaveAsFile();
          }}
        >
          Save as a file
        </Button>
      </div>
    </Dialog>
  );
}
