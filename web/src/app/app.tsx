// SPDX-License-Identifier: GPL-3.0-or-later
// The shell: top bar, rail, the page of the current place, and what belongs to all of them.
import { signal, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import type { Services } from '../crafts/common/services';
import type { ReliefPage as ReliefPageComponent } from '../crafts/relief/relief_page';
import type { ReliefSession } from '../crafts/relief/relief_session';
import { projectExtension } from '../project/archive';
import { Icon, TipLayer, toast, ToastLayer } from '../ui';
import { AboutPage } from './about_page';
import { crafts } from './crafts';
import { KeysDialog, WorkerDialog } from './dialogs';
import { LaterPage } from './later_page';
import { Rail } from './rail';
import { go, place } from './route';
import { formatNames, StartPage } from './start_page';
import { TopBar } from './top_bar';

type Page = typeof ReliefPageComponent;

/** The viewport is most of the program; it comes when a place needs it, or when the start screen is at rest. */
const reliefPage = signal<{ readonly Page: Page } | null>(null);
const loadReliefPage = () =>
  import('../crafts/relief/relief_page').then(({ ReliefPage }) => (reliefPage.value = { Page: ReliefPage }));

export interface AppProps {
  readonly services: Services;
  readonly session: ReliefSession;
}

export function App({ services, session }: AppProps) {
  const dialog = useSignal<'keys' | 'worker' | null>(null);
  const dropping = useSignal(false);
  const input = useRef<HTMLInputElement>(null);
  const chooseFile = () => input.current?.click();

  const openFile = async (file: File) => {
    if (file.name.toLowerCase().endsWith(`.${projectExtension}`)) {
      try {
        await services.projects.importFile(new Uint8Array(await file.arrayBuffer()));
        go('relief');
        toast(`Opened ${services.projects.document.value.name}.`);
      } catch (thrown) {
        const message = thrown instanceof Error ? thrown.message : String(thrown);
        session.problem.value = { kind: 'file', title: `Could not open ${file.name}`, message };
        go('relief');
      }
      return;
    }
    if (place.value === 'start' && !services.projects.isBlank.value) await services.projects.create();
    go('relief');
    await session.openFile(file);
  };

  useFileDrop(dropping, openFile);
  useGlobalKeys(services, { chooseFile, showKeys: () => (dialog.value = 'keys') });
  useLaunchedFiles(openFile);

  const where = place.value;
  const ReliefPage = reliefPage.value?.Page;
  useEffect(() => {
    if (where === 'relief') void loadReliefPage();
  }, [where]);
  const later = crafts.find((craft) => craft.place === where && !craft.available);
  const hasInspector = where === 'relief' && session.document.value.model !== null;
  const hasStrip = hasInspector || (where === 'relief' && session.activity.value.kind === 'opening');
  return (
    <div class={`app ${hasInspector ? 'with-side' : ''} ${hasStrip ? 'with-strip' : ''}`}>
      <TopBar
        services={services}
        session={session}
        onOpenFile={chooseFile}
        onKeys={() => (dialog.value = 'keys')}
        onWorker={() => (dialog.value = 'worker')}
      />
      <Rail />
      {where === 'relief' && ReliefPage ? (
        <ReliefPage
          session={session}
          onChooseFile={chooseFile}
          onWorkerHelp={() => (dialog.value = 'worker')}
          onStart={() => go('start')}
        />
      ) : where === 'relief' ? (
        <main class="view" aria-label="Relief" aria-busy="true" />
      ) : where === 'about' ? (
        <AboutPage services={services} />
      ) : later ? (
        <LaterPage craft={later} />
      ) : (
        <StartPage services={services} session={session} onChooseFile={chooseFile} />
      )}
      {dropping.value ? (
        <div class="drop-target" aria-hidden="true">
          <div>
            <Icon name="upload" />
            <h2>Drop to open</h2>
            <p>
              Meshes: {formatNames(services)}. Projects: .{projectExtension}.
            </p>
            <p>Your project is saved first.</p>
          </div>
        </div>
      ) : null}
      <input
        ref={input}
        type="file"
        hidden
        aria-label="Model or project file"
        accept={[
          ...(services.catalog.value?.mesh_formats ?? []).map((f) => `.${f.extension}`),
          `.${projectExtension}`,
        ].join()}
        onChange={(event) => {
          const file = event.currentTarget.files?.[0];
          event.currentTarget.value = '';
          if (file) void openFile(file);
        }}
      />
      {dialog.value === 'keys' ? <KeysDialog onClose={() => (dialog.value = null)} /> : null}
      {dialog.value === 'worker' ? (
        <WorkerDialog services={services} onClose={() => (dialog.value = null)} />
      ) : null}
      <ToastLayer />
      <TipLayer />
    </div>
  );
}

function useFileDrop(dropping: { value: boolean }, openFile: (file: File) => Promise<void>): void {
  useEffect(() => {
    let depth = 0; // dragenter and dragleave come for every element that is crossed
    const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') === true;
    const enter = (event: DragEvent) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      ++depth;
      dropping.value = true;
    };
    const over = (event: DragEvent) => {
      if (hasFiles(event)) event.preventDefault();
    };
    const leave = () => {
      depth = Math.max(0, depth - 1);
      if (depth === 0) dropping.value = false;
    };
    const drop = (event: DragEvent) => {
      depth = 0;
      dropping.value = false;
      const file = event.dataTransfer?.files[0];
      if (file === undefined) return;
      event.preventDefault();
      void openFile(file);
    };
    const handlers = { dragenter: enter, dragover: over, dragleave: leave, drop } as const;
    for (const [name, handler] of Object.entries(handlers))
      document.addEventListener(name, handler as EventListener);
    return () => {
      for (const [name, handler] of Object.entries(handlers))
        document.removeEventListener(name, handler as EventListener);
    };
  }, []);
}

function useGlobalKeys(services: Services, actions: { chooseFile: () => void; showKeys: () => void }): void {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.defaultPrevented || document.querySelector('dialog[open]')) return;
      const control = event.ctrlKey || event.metaKey;
      const typing = (event.target as Element).matches('input[type=text], textarea, select');
      const key = event.key.toLowerCase();
      const act = (action: () => void) => {
        event.preventDefault();
        action();
      };
      if (control && key === 'o') act(actions.chooseFile);
      else if (typing && control)
        return; // a text field undoes its own typing
      else if (control && key === 'z')
        act(() => (event.shiftKey ? services.projects.redo() : services.projects.undo()));
      else if (control && key === 'y') act(() => services.projects.redo());
      else if (typing || control || event.altKey) return;
      else if (key === '?') act(actions.showKeys);
      else if (/^[1-5]$/.test(key)) {
        const craft = crafts[Number(key) - 1];
        if (craft) act(() => go(craft.place));
      }
    };
    document.addEventListener('keydown', onKey);
    return () => document.removeEventListener('keydown', onKey);
  }, []);
}

interface LaunchQueue {
  setConsumer(consumer: (launch: { files: readonly { getFile(): Promise<File> }[] }) => void): void;
}

/** Files opened with the installed app from the system's file manager. */
function useLaunchedFiles(openFile: (file: File) => Promise<void>): void {
  useEffect(() => {
    const { launchQueue } = window as { launchQueue?: LaunchQueue };
    launchQueue?.setConsumer(({ files }) => {
      void files[0]?.getFile().then(openFile);
    });
  }, []);
}
