// SPDX-License-Identifier: GPL-3.0-or-later
import { useState } from 'preact/hooks';
import type { Services } from '../../shared/session/services';
import { Button, Dialog, Icon, Menu } from '../../ui';
import { saveAsFile } from '../project_file';
import { copyLink, hintOf, LinkDialog } from '../share/copy_link';
import type { ProjectLink } from '../share/project_link';
import { linkTo } from '../share/project_link';
import { placeOfWork } from '../rooms';
import { go, place } from '../route';
import { toastFailure } from '../failure_toast';

const listedProjects = 8;

export function ProjectMenu({ services, onOpenFile }: { services: Services; onOpenFile: () => void }) {
  const { projects } = services;
  const { id, name } = projects.document.value;
  const [dialog, setDialog] = useState<'rename' | 'delete' | null>(null);
  const [shown, setShown] = useState<ProjectLink | null>(null);
  const catalog = services.catalog.value;
  const link = catalog && linkTo(projects.document.value, catalog, place.value);
  const blank = projects.isBlank.value ? 'Empty project' : undefined;
  const open = async (other: string) => {
    await projects.open(other);
    go(placeOfWork(projects.document.value) ?? 'relief');
  };
  const others = projects.projects.value.slice(0, listedProjects);
  return (
    <>
      <Menu
        title="Projects"
        buttonClass="project"
        items={[
          {
            label: 'New project',
            icon: 'plus',
            onSelect: () => toastFailure(projects.create().then(() => go('start'))),
          },
          { label: 'Open a file', hint: 'Ctrl + O', icon: 'upload', onSelect: onOpenFile },
          {
            label: 'Save as a file',
            icon: 'download',
            disabledReason: blank,
            onSelect: () => toastFailure(saveAsFile(projects)),
          },
          {
            label: 'Copy a link',
            icon: 'link',
            hint: link ? hintOf(link) : undefined,
            disabledReason: blank ?? (link ? undefined : 'The solver has not started'),
            onSelect: () => {
              if (link) void copyLink(link).then((copied) => copied || setShown(link));
            },
          },
          null,
          { label: 'Rename', icon: 'pencil', disabledReason: blank, onSelect: () => setDialog('rename') },
          {
            label: 'Duplicate',
            icon: 'copy',
            disabledReason: blank,
            onSelect: () => toastFailure(projects.duplicate()),
          },
          {
            label: 'Delete',
            icon: 'trash',
            danger: blank === undefined,
            disabledReason: blank,
            onSelect: () => setDialog('delete'),
          },
          ...(others.length > 0 ? [null] : []),
          ...others.map((other) => ({
            label: other.name,
            hint: dateOf(other.modified_unix_s),
            checked: other.id === id,
            onSelect: () => toastFailure(open(other.id)),
          })),
        ]}
      >
        <span class="clip">{name}</span>
        <Icon name="chevronDown" small />
      </Menu>
      {shown ? (
        <LinkDialog
          link={shown}
          onSaveAsFile={() => toastFailure(saveAsFile(projects))}
          onClose={() => setShown(null)}
        />
      ) : null}
      {dialog === 'rename' ? (
        <Dialog title="Rename the project" onClose={() => setDialog(null)}>
          <form
            method="dialog"
            onSubmit={(event) => {
              event.preventDefault();
              projects.rename(String(new FormData(event.currentTarget).get('name')));
              setDialog(null);
            }}
          >
            <input class="text-field" name="name" aria-label="Name" value={name} maxLength={80} autoFocus />
            <div class="row end">
              <Button onClick={() => setDialog(null)}>Cancel</Button>
              <Button kind="filled" type="submit">
                Rename
              </Button>
            </div>
          </form>
        </Dialog>
      ) : null}
      {dialog === 'delete' ? (
        <Dialog title={`Delete “${name}”?`} onClose={() => setDialog(null)}>
          <p>Its model, settings and results leave this browser. Save it as a file first to keep them.</p>
          <div class="row end">
            <Button onClick={() => setDialog(null)}>Keep it</Button>
            <Button
              kind="danger"
              onClick={() => {
                setDialog(null);
                toastFailure(projects.remove(id).then(() => go('start')));
              }}
            >
              Delete
            </Button>
          </div>
        </Dialog>
      ) : null}
    </>
  );
}

function dateOf(unix_s: number): string {
  const date = new Date(unix_s * 1000);
  const today = date.toDateString() === new Date().toDateString();
  return today
    ? date.toLocaleTimeString('en-GB', { hour: '2-digit', minute: '2-digit' })
    : date.toLocaleDateString('en-GB', { day: 'numeric', month: 'short' });
}
