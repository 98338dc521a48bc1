import { chromium } from '@playwright/test';
const [,, width='1280', scheme='light', file='bunny.obj', tag='a'] = process.argv;
const b = await chromium.launch({ executablePath:'/usr/bin/chromium', args:['--headless=new','--no-sandbox'] });
const c = await b.newContext({ viewport:{width:+width,height:width==='390'?844:800}, colorScheme: scheme, reducedMotion:'reduce' });
const p = await c.newPage();
p.on('pageerror', e=>console.log('ERR',e)); p.on('console', m=>m.type()==='error'&&console.log('CON',m.text()));
const shot = async n => { await p.waitForTimeout(1500); await p.screenshot({path:`/tmp/looks/${tag}_${width}_${scheme}_${n}.png`}); console.log(n); };
await p.goto('http://127.0.0.1:5722/');
await p.getByRole('link',{name:'Thermoform',exact:true}).click();
await p.locator('input[type=file]').setInputFiles('/work/shared/data/'+file);
await p.locator('footer strong').getByText('Preview up to date').waitFor({timeout:120000});
await shot('1open');
if (width==='390') { await p.getByRole('button',{name:/Parameters/}).first().click().catch(e=>console.log('no sheet',e.message.slice(0,200))); await shot('1sheet'); }
const t0=Date.now();
await p.getByRole('button',{name:'Place on face'}).click();
await p.getByRole('listbox').waitFor(); console.log('faces in ms', Date.now()-t0);
await p.keyboard.press('ArrowDown'); await p.keyboard.press('ArrowDown');
await shot('2faces');
console.log(await p.getByRole('option').allTextContents());
await p.keyboard.press('Enter');
await p.waitForTimeout(3000); await shot('3placed');
await p.locator('footer strong').getByText('Preview up to date').waitFor({timeout:60000}).catch(()=>console.log('not up to date'));
if (width!=='390') {
 const h = p.getByRole('button',{name:/^Tilt the model sideways/});
 await h.hover(); await shot('4hover');
 const box = await h.boundingBox(); await p.mouse.move(box.x+14,box.y+14); await p.mouse.down(); await p.mouse.move(box.x+60,box.y+50,{steps:6}); await shot('5tilting'); await p.mouse.up();
 await p.waitForTimeout(3000); await shot('6tilted');
 const g = p.getByRole('button',{name:/^Turn the model/}); const gb=await g.boundingBox(); await p.mouse.move(gb.x+14,gb.y+14); await p.mouse.down(); await p.mouse.move(gb.x+44,gb.y-60,{steps:6}); await shot('7turning'); await p.mouse.up();
}
await p.getByRole('button',{name:'Lay it on its'}).count();
await b.close();
