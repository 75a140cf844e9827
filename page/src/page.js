// Where the page begins: `data-page` of the body says which one it is.
import {startServe} from "./serve.js";
import {startView} from "./view.js";

({view: startView, serve: startServe})[document.body.dataset.page]();
