// SPDX-License-Identifier: GPL-3.0-or-later
import type { Services } from '../../shared/session/services';
import { IconButton, Menu, Icon, tipHandlers } from '../../ui';
import { ProjectMenu } from './project_menu';
import { go } from '../route';
import { SaveState } from './save_state';
import { chooseTheme, theme } from '../theme';

export interface TopBarProps {
  readonly services: Services;
  /** Something is being solved in full. */
  readonly solving: boolean;
  readonly onOpenFile: () => void;
  readonly onKeys: () => void;
  readonly onWorker: () => void;
  readonly onLearn: () => void;
}

export function TopBar({ services, solving, onOpenFile, onKeys, onWorker, onLearn }: TopBarProps) {
  const { projects } = services;
  const { value: undo } = projects.undoLabel;
  const { value: redo } = projects.redoLabel;
  const dark = theme.value === 'dark';
  return (
    <header class="top">
      <a class="logo" href="#/start" aria-label="Formwright, start">
        <svg
          width="26"
          height="26"
          viewBox="0 0 26 26"
          fill="none"
          aria-hidden="true"
          stroke-width="2.2"
          stroke-linecap="round"
        >
          <path d="M3 22.5h20" stroke="currentColor" />
          <path d="M3 17c4.5 0 5-12.5 10-12.5S18.5 17 23 17" stroke="currentColor" />
          <circle cx="13" cy="4.5" r="2.6" fill="var(--live)" />
        </svg>
      </a>
      <ProjectMenu services={services} onOpenFile={onOpenFile} />
      <SaveState projects={projects} />
      <span class="grow" />
      <IconButton
        icon="undo"
        class="desk"
        label={undo ? `Undo: ${undo}` : 'Nothing to undo'}
        keys="Control+Z"
        disabled={undo === null}
        onClick={() => projects.undo()}
      />
      <IconButton
        icon="redo"
        class="desk"
        label={redo ? `Redo: ${redo}` : 'Nothing to redo'}
        keys="Control+Shift+Z"
        disabled={redo === null}
        onClick={() => projects.redo()}
      />
      <span class="separator desk" />
      <WorkerChip services={services} solving={solving} onWorker={onWorker} />
      <IconButton
        icon={dark ? 'moon' : 'sun'}
        label={dark ? 'Change to the light theme' : 'Change to the dark theme'}
        onClick={() => chooseTheme(dark ? 'light' : 'dark')}
      />
      <Menu
        label="Help"
        buttonClass="icon-button"
        align="right"
        items={[
          { label: 'Learn: tutorials', onSelect: onLearn },
          { label: 'All keys', hint: '?', onSelect: onKeys },
          { label: 'Where models are solved', onSelect: onWorker },
          { label: 'About Formwright', onSelect: () => go('about') },
        ]}
      >
        <Icon name="help" />
      </Menu>
    </header>
  );
}

function WorkerChip({
  services,
  solving,
  onWorker,
}: {
  services: Services;
  solving: boolean;
  onWorker: () => void;
}) {
  const connection = services.connection.value;
  const mock = services.browser.kind === 'mock';
  let [dot, words, short] = ['off', mock ? 'Mock solver' : 'In the browser', mock ? 'Mock' : 'In browser'];
  if (connection?.state === 'ready') {
    const { cores } = connection.status;
    [dot, words, short] = [
      '',
      `Worker program · ${cores} ${cores === 1 ? 'core' : 'cores'} · ready`,
      'Ready',
    ];
    if (solving) [dot, words, short] = ['live', words.replace('ready', 'solving'), 'Solving'];
  } else if (connection?.state === 'connecting')
    [dot, words, short] = ['off', 'Connecting to the worker program', 'Connecting'];
  else if (connection?.state === 'lost')
    [dot, words, short] = ['attention', 'Worker program lost · solving in the browser', 'Worker lost'];
  else if (connection?.state === 'refused')
    [dot, words, short] = ['bad', 'The worker program refused this page', 'Worker refused'];
  else if (solving) [dot, words, short] = ['live', 'In the browser · solving', 'Solving'];
  return (
    <button type="button" class="chip" onClick={onWorker} {...tipHandlers('Where models are solved')}>
      <i class={`dot ${dot}`} />
      <span class="desk-text">{words}</span>
      <span class="phone-text">{short}</span>
    </button>
  );
}
